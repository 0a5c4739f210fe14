# cmake -DINCLUDE_DIR=... -P check_borders.cmake
#
# Third-party headers stay where nvcc does not see them: Eigen in eigen.hpp, fmt in the printed plan
# and reports, file formats in io. A header of the device folders that includes one of them compiles
# on the host and breaks, or turns into a trap, in a kernel.
set(forbidden "<(Eigen|unsupported/Eigen|fmt|catch2|nlohmann|toml\\+\\+|CLI|stb|benchmark|dlpack)/")
set(device_folders core mpm pbd coupling geometry effects backend rl)
set(mistakes "")
foreach(folder IN LISTS device_folders)
  file(GLOB_RECURSE headers "${INCLUDE_DIR}/mpmpbd/${folder}/*.hpp" "${INCLUDE_DIR}/mpmpbd/${folder}/*.cuh")
  foreach(header IN LISTS headers)
    file(STRINGS "${header}" lines REGEX "^ *# *include *${forbidden}")
    if(lines)
      string(APPEND mistakes "  ${header}: ${lines}\n")
    endif()
  endforeach()
endforeach()
if(mistakes)
  message(FATAL_ERROR "headers that a kernel may see include a host library:\n${mistakes}")
endif()
