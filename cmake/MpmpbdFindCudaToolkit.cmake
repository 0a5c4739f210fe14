# find_package(CUDAToolkit), used by the build and by the installed package.
#
# CMake 3.25 (Debian 12) marks CUDA::nvToolsExt as deprecated for projects that require CMake >= 3.25.
# CUDA 13 has no such library, and so the search ends in an error. The mark depends on nothing but
# this variable.
macro(mpmpbd_find_cuda_toolkit)
  set(_mpmpbd_minimum_required "${CMAKE_MINIMUM_REQUIRED_VERSION}")
  if(CMAKE_VERSION VERSION_LESS 3.26 AND CMAKE_MINIMUM_REQUIRED_VERSION VERSION_GREATER_EQUAL 3.25)
    set(CMAKE_MINIMUM_REQUIRED_VERSION 3.24)
  endif()
  find_package(CUDAToolkit ${ARGN} QUIET)
  set(CMAKE_MINIMUM_REQUIRED_VERSION "${_mpmpbd_minimum_required}")
  unset(_mpmpbd_minimum_required)
endmacro()
