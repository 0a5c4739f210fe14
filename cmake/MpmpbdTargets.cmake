# The targets that users link. Each is a step up from the one before:
#   mpmpbd::core     headers, no dependency: all that a .cu sees
#   mpmpbd::mpmpbd   core, Eigen at the host border, fmt for plans and reports, OpenMP if present
#   mpmpbd::io       mpmpbd, and the file formats whose libraries are present
#   mpmpbd::rl       io, and the random numbers that learning needs (Random123)
#   mpmpbd::testing  mpmpbd, and the law suites, for users who test their own policies
#   mpmpbd::cuda     core, and what nvcc needs
#   mpmpbd::catalog  ready-made scenes, compiled (src/catalog)

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(OpenMP QUIET COMPONENTS CXX)
find_package(nlohmann_json QUIET)
find_package(tomlplusplus QUIET)
find_package(Random123 QUIET)
find_package(Hdf5C QUIET)

# An optional dependency: linked where its target exists, both here and in an installed package.
function(_mpmpbd_link_if_exists target)
  foreach(dependency IN LISTS ARGN)
    target_link_libraries(${target} INTERFACE
      "$<$<TARGET_EXISTS:${dependency}>:${dependency}>")
  endforeach()
endfunction()

function(_mpmpbd_interface name)
  add_library(mpmpbd_${name} INTERFACE)
  set_target_properties(mpmpbd_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(mpmpbd::${name} ALIAS mpmpbd_${name})
endfunction()

_mpmpbd_interface(core)
target_include_directories(mpmpbd_core INTERFACE
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
target_compile_features(mpmpbd_core INTERFACE cxx_std_20)
# Without this, g++ fuses a * b + c into one rounding wherever the target has FMA: the same source
# would give other bits with -march=native, and the vector kernels chosen at run time other bits than
# the scalar ones. It is a usage requirement, not only a flag of our builds, because the loops are
# templates: users compile them. A .cu is treated alike by nvcc, both halves of it, in mpmpbd::cuda.
target_compile_options(mpmpbd_core INTERFACE
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-ffp-contract=off>")

_mpmpbd_interface(mpmpbd)
target_link_libraries(mpmpbd_mpmpbd INTERFACE mpmpbd_core Eigen3::Eigen fmt::fmt)
# The threads back end is OpenMP; without it the same text runs on one thread.
_mpmpbd_link_if_exists(mpmpbd_mpmpbd OpenMP::OpenMP_CXX)

_mpmpbd_interface(io)
target_link_libraries(mpmpbd_io INTERFACE mpmpbd_mpmpbd)
_mpmpbd_link_if_exists(mpmpbd_io
  nlohmann_json::nlohmann_json tomlplusplus::tomlplusplus Hdf5C::Hdf5C)

# Its public name exists where Random123 does.
add_library(mpmpbd_rl INTERFACE)
set_target_properties(mpmpbd_rl PROPERTIES EXPORT_NAME rl)
target_link_libraries(mpmpbd_rl INTERFACE mpmpbd_io)
_mpmpbd_link_if_exists(mpmpbd_rl Random123::Random123)
if(Random123_FOUND)
  add_library(mpmpbd::rl ALIAS mpmpbd_rl)
else()
  message(STATUS "mpmpbd: no step loops (they need Random123; scripts/setup.sh installs it)")
endif()

_mpmpbd_interface(testing)
target_link_libraries(mpmpbd_testing INTERFACE mpmpbd_mpmpbd)

# Defined always, because it is only flags and headers: a package that was built without CUDA serves
# a user who has it. Its public name exists where CUDA does.
add_library(mpmpbd_cuda INTERFACE)
set_target_properties(mpmpbd_cuda PROPERTIES EXPORT_NAME cuda)
target_link_libraries(mpmpbd_cuda INTERFACE mpmpbd_core
  # The run-time library that CMake gives the same target: two of them in one program are two states.
  "$<IF:$<STREQUAL:$<UPPER_CASE:$<TARGET_PROPERTY:CUDA_RUNTIME_LIBRARY>>,SHARED>,CUDA::cudart,CUDA::cudart_static>")
target_compile_options(mpmpbd_cuda INTERFACE
  # By hand: CMake 3.25 drops CUDA_STANDARD 20 silently, and a cuda_std_20 feature is an error there.
  "$<$<COMPILE_LANGUAGE:CUDA>:-std=c++20>"
  # A host function of a .cu gives the bits of the same function in a .cpp, and a device function the
  # same bits in every kernel: products are joined with sums by multiply_add, never by nvcc (decision 32).
  "$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=-ffp-contract=off;-fmad=false>")
if(MPMPBD_HAS_CUDA)
  add_library(mpmpbd::cuda ALIAS mpmpbd_cuda)
endif()

if(OpenMP_CXX_FOUND)
  message(STATUS "mpmpbd: threads by OpenMP ${OpenMP_CXX_VERSION}")
else()
  message(STATUS "mpmpbd: no OpenMP, the threads back end runs on one thread")
endif()
