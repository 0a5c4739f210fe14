# mpmpbd::warnings: what our own sources are compiled with. Never installed, never seen by users.
add_library(mpmpbd_warnings INTERFACE)
add_library(mpmpbd::warnings ALIAS mpmpbd_warnings)

set(MPMPBD_CXX_WARNINGS
  -Wall -Wextra -Wpedantic
  -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast -Wcast-align -Wunused
  -Wconversion         # a double that becomes a float loses half of its digits silently
  -Wno-sign-conversion # counts are int, sizes of the standard library are not: only noise
  -Wformat=2 -Wundef)
# For the library only: a float kernel that computes in double by accident. Tests compare float
# results with double references on purpose.
set(MPMPBD_LIBRARY_WARNINGS -Wdouble-promotion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND MPMPBD_CXX_WARNINGS -Wduplicated-cond -Wlogical-op)
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms inside std::string when it is inlined (GCC bugs 105329 and 105651).
    list(APPEND MPMPBD_CXX_WARNINGS -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread
      -Wno-array-bounds)
  endif()
endif()
# nvcc's host pass: its generated code does not survive -Wpedantic, -Wold-style-cast or -Wundef.
# The last three are the false alarms of above.
set(MPMPBD_CUDA_WARNINGS
  -Xcompiler=-Wall,-Wextra,-Wshadow,-Wno-restrict,-Wno-stringop-overflow,-Wno-array-bounds)
if(MPMPBD_WARNINGS_AS_ERRORS)
  list(APPEND MPMPBD_CXX_WARNINGS -Werror)
  list(APPEND MPMPBD_CUDA_WARNINGS -Xcompiler=-Werror --Werror=all-warnings)
endif()
# 20011, 20013, 20014, 20015: a host function is called from a kernel; 20012: an annotation is
# ignored. nvcc only warns, and the kernel that comes out is a trap or empty.
set(MPMPBD_CUDA_DIAGNOSTICS -diag-error=20011,20012,20013,20014,20015)

if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(mpmpbd_warnings INTERFACE
    "$<$<COMPILE_LANGUAGE:CXX>:${MPMPBD_CXX_WARNINGS}>"
    "$<$<COMPILE_LANGUAGE:CUDA>:${MPMPBD_CUDA_WARNINGS};${MPMPBD_CUDA_DIAGNOSTICS}>")
endif()
