# Tests whose subject is the compiler: programs that must not compile, headers that must compile
# alone, and programs that are not built every time and must go on to compile.

# The include folders of the tests as they stand on a command line: ours, and as system folders those
# of the libraries. Ours must not be there twice, or their warnings are gone; /usr/include not at all,
# because named by hand it comes before the compiler's own headers.
set(_ours "${PROJECT_SOURCE_DIR}/include")
set(_tests "${PROJECT_SOURCE_DIR}/tests")
set(_all "$<TARGET_PROPERTY:mpmpbd_test_base,INCLUDE_DIRECTORIES>")
set(_theirs "$<REMOVE_DUPLICATES:$<FILTER:${_all},EXCLUDE,^(/usr/include|${_ours}|${_tests})/?$>>")
set(MPMPBD_INCLUDE_FLAGS "-I${_ours}" "-I${_tests}"
  "$<$<BOOL:${_theirs}>:-isystem$<SEMICOLON>$<JOIN:${_theirs},$<SEMICOLON>-isystem$<SEMICOLON>>>")

# The compilers a failing program is shown to: the two of Debian where present, and the configured one, in the place of
# its namesake, for tests are named after them.
function(_mpmpbd_find_compilers out)
  set(found "")
  cmake_path(GET CMAKE_CXX_COMPILER FILENAME configured)
  foreach(name IN ITEMS g++ clang++)
    if(name STREQUAL configured)
      continue()
    endif()
    string(MAKE_C_IDENTIFIER "MPMPBD_FAIL_${name}" variable)
    find_program(${variable} ${name})
    mark_as_advanced(${variable})
    if(${variable})
      list(APPEND found "${${variable}}")
    endif()
  endforeach()
  list(APPEND found "${CMAKE_CXX_COMPILER}")
  set(unique "")
  set(seen "")
  foreach(compiler IN LISTS found)
    file(REAL_PATH "${compiler}" real)
    if(NOT real IN_LIST seen)
      list(APPEND seen "${real}")
      list(APPEND unique "${compiler}")
    endif()
  endforeach()
  set(${out} ${unique} PARENT_SCOPE)
endfunction()

# mpmpbd_add_fail_tests(<folder>): every .cpp there is compiled by every compiler twice, with
# -DMPMPBD_FIXED (has to compile) and without (has to fail with the sentence of `// expect: `).
# nvcc joins for files that say `// also: nvcc`.
function(mpmpbd_add_fail_tests folder)
  _mpmpbd_find_compilers(compilers)
  file(GLOB sources CONFIGURE_DEPENDS "${folder}/*.cpp")
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM name)
    if(name MATCHES "^task_" AND NOT TARGET mpmpbd::rl)
      continue()
    endif()
    set(cases ${compilers})
    file(STRINGS "${source}" also REGEX "^// also: nvcc")
    if(also AND MPMPBD_HAS_CUDA)
      list(APPEND cases "${CMAKE_CUDA_COMPILER}")
    endif()
    foreach(compiler IN LISTS cases)
      cmake_path(GET compiler FILENAME tag)
      add_test(NAME "fail/${name} ${tag}"
        COMMAND "${CMAKE_COMMAND}"
          "-DSOURCE=${source}"
          "-DCOMPILER=${compiler}"
          "-DFLAGS=-std=c++20;${MPMPBD_INCLUDE_FLAGS}"
          -P "${PROJECT_SOURCE_DIR}/cmake/check_compile_fail.cmake")
      set_tests_properties("fail/${name} ${tag}" PROPERTIES LABELS fail TIMEOUT 120)
    endforeach()
  endforeach()
endfunction()

# mpmpbd_add_read_test(<program> <source>): the compiler reads what it would need to make the program, with all
# templates, and makes nothing: a fifth of the time.
function(mpmpbd_add_read_test program source)
  set(here "$<TARGET_PROPERTY:${program},INCLUDE_DIRECTORIES>")
  add_test(NAME "read/${program}"
    COMMAND "${CMAKE_CXX_COMPILER}" -std=c++20 ${OpenMP_CXX_FLAGS} ${MPMPBD_CXX_WARNINGS} -Werror
      "$<$<BOOL:${here}>:-I$<JOIN:${here},$<SEMICOLON>-I>>" ${MPMPBD_INCLUDE_FLAGS} -fsyntax-only "${source}"
    COMMAND_EXPAND_LISTS)
  set_tests_properties("read/${program}" PROPERTIES LABELS headers TIMEOUT 300)
endfunction()

# mpmpbd_add_header_tests(<include folder>): every header is all of a translation unit, with our
# warnings as errors; .hpp by the configured compiler, .cuh by nvcc.
function(mpmpbd_add_header_tests include_dir)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${include_dir}"
    "${include_dir}/mpmpbd/*.hpp" "${include_dir}/mpmpbd/*.cuh")
  if(NOT TARGET mpmpbd::rl)
    list(FILTER headers EXCLUDE REGEX "^mpmpbd/(rl/|catalog/suturing_task)")
  endif()
  set(compile "${CMAKE_CXX_COMPILER}" -std=c++20 ${MPMPBD_CXX_WARNINGS} ${MPMPBD_LIBRARY_WARNINGS}
    -Werror ${MPMPBD_INCLUDE_FLAGS} -x c++ -fsyntax-only)
  foreach(header IN LISTS headers)
    if(header MATCHES "\\.cuh$")
      if(NOT MPMPBD_HAS_CUDA)
        continue()
      endif()
      list(GET CMAKE_CUDA_ARCHITECTURES 0 arch)
      string(REGEX MATCH "^[0-9]+" arch "${arch}")
      set(command "${CMAKE_CUDA_COMPILER}" -std=c++20 -arch=sm_${arch} ${MPMPBD_CUDA_DIAGNOSTICS}
        --Werror=all-warnings ${MPMPBD_INCLUDE_FLAGS} -x cu -ptx -o /dev/null -include "${header}")
    else()
      set(command ${compile} -include "${header}")
    endif()
    string(REGEX REPLACE "^mpmpbd/" "headers/" name "${header}")
    add_test(NAME "${name}" COMMAND ${command} /dev/null COMMAND_EXPAND_LISTS)
    set_tests_properties("${name}" PROPERTIES LABELS headers TIMEOUT 120)
  endforeach()

  # All together, in both orders: a name that two headers define, or one that leans on another.
  list(FILTER headers INCLUDE REGEX "\\.hpp$")
  list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>")
  foreach(order IN ITEMS forward backward)
    list(JOIN headers "\n" text)
    file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/all_${order}.cpp" CONTENT "${text}\n" @ONLY)
    add_test(NAME "headers/all ${order}"
      COMMAND ${compile} "${CMAKE_CURRENT_BINARY_DIR}/all_${order}.cpp" COMMAND_EXPAND_LISTS)
    set_tests_properties("headers/all ${order}" PROPERTIES LABELS headers TIMEOUT 120)
    list(REVERSE headers)
  endforeach()

  add_test(NAME headers/borders
    COMMAND "${CMAKE_COMMAND}" "-DINCLUDE_DIR=${include_dir}"
      -P "${PROJECT_SOURCE_DIR}/cmake/check_borders.cmake")
  set_tests_properties(headers/borders PROPERTIES LABELS headers)
endfunction()
