# Decides MPMPBD_CUDA = AUTO | ON | OFF and sets MPMPBD_HAS_CUDA.
#
# A toolkit is enough: no GPU is needed to configure or to compile.
include(MpmpbdFindCudaToolkit)

# 12.4 is the first nvcc whose C++20 compiles our headers; Debian 12 packages 11.8.
set(MPMPBD_CUDA_MINIMUM 12.4)
set(MPMPBD_HAS_CUDA FALSE)
set(MPMPBD_CUDA_COMPILED_WITH "" CACHE INTERNAL "The CUDA compiler in use; scripts read it")

# Where the decision and its reason go: a hard stop for ON, one line for AUTO.
macro(_mpmpbd_without_cuda reason)
  if(MPMPBD_CUDA STREQUAL "ON")
    message(FATAL_ERROR
      "mpmpbd: MPMPBD_CUDA=ON, but ${reason}. Install a CUDA toolkit >= ${MPMPBD_CUDA_MINIMUM} and "
      "name its compiler by -DCMAKE_CUDA_COMPILER=/path/to/nvcc, or configure with "
      "-DMPMPBD_CUDA=OFF")
  endif()
  message(STATUS "mpmpbd: CUDA off (${reason})")
endmacro()

# Sets `out` to the version of the compiler `nvcc`, or to nothing.
function(_mpmpbd_nvcc_version nvcc out)
  execute_process(COMMAND "${nvcc}" --version
    OUTPUT_VARIABLE text ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND text MATCHES "V([0-9]+\\.[0-9]+\\.[0-9]+)")
    set(${out} "${CMAKE_MATCH_1}" PARENT_SCOPE)
  else()
    set(${out} "" PARENT_SCOPE)
  endif()
endfunction()

# Normalise ON/TRUE/1 and OFF/FALSE/0, and refuse the rest.
string(TOUPPER "${MPMPBD_CUDA}" MPMPBD_CUDA)
if(NOT MPMPBD_CUDA STREQUAL "AUTO")
  if(MPMPBD_CUDA MATCHES "^(ON|TRUE|YES|1)$")
    set(MPMPBD_CUDA ON)
  elseif(MPMPBD_CUDA MATCHES "^(OFF|FALSE|NO|0)$")
    set(MPMPBD_CUDA OFF)
  else()
    message(FATAL_ERROR "mpmpbd: MPMPBD_CUDA is '${MPMPBD_CUDA}'; write AUTO, ON or OFF")
  endif()
endif()

# Never `native`: that is a configure error on a machine without a GPU.
if(NOT MPMPBD_CUDA STREQUAL "OFF" AND NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES "75;89;90" CACHE STRING "GPU architectures to compile for")
endif()

if(MPMPBD_CUDA STREQUAL "OFF")
  message(STATUS "mpmpbd: CUDA off (MPMPBD_CUDA=OFF)")
else()
  get_property(_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  if(NOT "CUDA" IN_LIST _languages AND NOT CMAKE_CUDA_COMPILER)
    # The first of CUDACXX, PATH, CUDA_HOME and the usual folder, by its version before anything is
    # compiled with it.
    set(_nvcc "$ENV{CUDACXX}")
    if(NOT _nvcc)
      find_program(MPMPBD_NVCC nvcc
        HINTS ENV CUDA_HOME ENV CUDA_PATH PATHS /usr/local/cuda PATH_SUFFIXES bin)
      mark_as_advanced(MPMPBD_NVCC)
      set(_nvcc "${MPMPBD_NVCC}")
    endif()
    if(_nvcc)
      _mpmpbd_nvcc_version("${_nvcc}" _version)
      if(_version VERSION_GREATER_EQUAL MPMPBD_CUDA_MINIMUM)
        set(ENV{CUDACXX} "${_nvcc}")
        include(CheckLanguage)
        check_language(CUDA)  # in a project of its own: AUTO goes on when nvcc is broken
        set(_reason "${_nvcc} does not compile; see CMakeFiles/CMakeError.log")
      elseif(_version)
        set(_reason "${_nvcc} is version ${_version}, older than ${MPMPBD_CUDA_MINIMUM}")
      else()
        set(_reason "${_nvcc} does not tell its version")
      endif()
    else()
      set(_reason "no nvcc was found")
    endif()
  endif()

  if("CUDA" IN_LIST _languages OR CMAKE_CUDA_COMPILER)
    enable_language(CUDA)
    mpmpbd_find_cuda_toolkit()
    if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS MPMPBD_CUDA_MINIMUM)
      _mpmpbd_without_cuda(
        "${CMAKE_CUDA_COMPILER} is version ${CMAKE_CUDA_COMPILER_VERSION}, older than ${MPMPBD_CUDA_MINIMUM}")
    elseif(NOT CUDAToolkit_FOUND)
      _mpmpbd_without_cuda("the CUDA run-time library was not found beside ${CMAKE_CUDA_COMPILER}")
    else()
      set(MPMPBD_HAS_CUDA TRUE)
      set(MPMPBD_CUDA_COMPILED_WITH "nvcc ${CMAKE_CUDA_COMPILER_VERSION}" CACHE INTERNAL "")
      message(STATUS "mpmpbd: CUDA on (nvcc ${CMAKE_CUDA_COMPILER_VERSION}, "
        "architectures ${CMAKE_CUDA_ARCHITECTURES})")
    endif()
  else()
    _mpmpbd_without_cuda("${_reason}")
  endif()
endif()
