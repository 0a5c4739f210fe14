# cmake -DSOURCE=... -DCOMPILER=... -DFLAGS=... -P check_compile_fail.cmake
#
# SOURCE has to compile with -DMPMPBD_FIXED, so that it fails for no other reason than the one it
# shows, and has to fail without it, with every sentence of its lines `// expect: <sentence>` in the
# output. White space counts as one blank: compilers break lines where they like.

file(STRINGS "${SOURCE}" lines REGEX "^// expect: ")
if(NOT lines)
  message(FATAL_ERROR "${SOURCE}: say the expected sentence in a line `// expect: <sentence>`")
endif()
file(STRINGS "${SOURCE}" fixed REGEX "MPMPBD_FIXED")
if(NOT fixed)
  message(FATAL_ERROR "${SOURCE}: show the correct program too, in `#ifdef MPMPBD_FIXED`")
endif()

cmake_path(GET COMPILER FILENAME name)
if(name MATCHES "nvcc")
  set(mode -x cu -ptx -o /dev/null)
else()
  set(mode -fsyntax-only)
endif()

execute_process(COMMAND "${COMPILER}" ${FLAGS} ${mode} -DMPMPBD_FIXED "${SOURCE}"
  RESULT_VARIABLE failed OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(failed)
  message(FATAL_ERROR "${SOURCE}: with -DMPMPBD_FIXED it has to compile, but ${name} says:\n${out}")
endif()

execute_process(COMMAND "${COMPILER}" ${FLAGS} ${mode} "${SOURCE}"
  RESULT_VARIABLE failed OUTPUT_VARIABLE out ERROR_VARIABLE out)
if(NOT failed)
  message(FATAL_ERROR "${SOURCE}: ${name} compiles it, but it has to be refused")
endif()
string(REGEX REPLACE "[ \t\r\n]+" " " text "${out}")
# Compilers quote our sentence as a string literal.
string(REPLACE "\\\"" "\"" text "${text}")
file(READ "${SOURCE}" source)
while(source MATCHES "(^|\n)// expect: ([^\n]*)")
  set(sentence "${CMAKE_MATCH_2}")
  string(FIND "${source}" "// expect: ${sentence}" at)
  math(EXPR at "${at} + 11")
  string(SUBSTRING "${source}" ${at} -1 source)
  string(REGEX REPLACE "[ \t\r\n]+" " " sentence "${sentence}")
  string(STRIP "${sentence}" sentence)
  string(FIND "${text}" "${sentence}" found)
  if(found EQUAL -1)
    message(FATAL_ERROR
      "${SOURCE}: ${name} refuses it, but without the sentence\n  ${sentence}\nIt says:\n${out}")
  endif()
endwhile()
