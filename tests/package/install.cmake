# cmake -DBUILD_DIR=... -DPREFIX=... -DCONFIG=... -P install.cmake
# A fresh prefix each time: a header that was removed must not survive in it.
file(REMOVE_RECURSE "${PREFIX}")
execute_process(
  COMMAND "${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${PREFIX}" --config "${CONFIG}"
  COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
