# Installation, the package that find_package(mpmpbd) reads, and a Debian package by `cpack -G DEB`.
include(CMakePackageConfigHelpers)

set(_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/mpmpbd")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/mpmpbd" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.cuh")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

install(TARGETS mpmpbd_core mpmpbd_mpmpbd mpmpbd_io mpmpbd_testing EXPORT mpmpbd-targets)
install(EXPORT mpmpbd-targets NAMESPACE mpmpbd:: DESTINATION "${_package_dir}")

# Sets of their own: they need Random123, or a CUDA toolkit, on the user's machine; the rest does not.
install(TARGETS mpmpbd_rl EXPORT mpmpbd-rl-targets)
install(EXPORT mpmpbd-rl-targets NAMESPACE mpmpbd:: DESTINATION "${_package_dir}")
install(TARGETS mpmpbd_cuda EXPORT mpmpbd-cuda-targets)
if(TARGET mpmpbd_catalog_cuda)
  install(TARGETS mpmpbd_catalog_cuda EXPORT mpmpbd-cuda-targets)
endif()
install(EXPORT mpmpbd-cuda-targets NAMESPACE mpmpbd:: DESTINATION "${_package_dir}")
if(TARGET mpmpbd_catalog)
  install(TARGETS mpmpbd_catalog EXPORT mpmpbd-catalog-targets)
  install(EXPORT mpmpbd-catalog-targets NAMESPACE mpmpbd:: DESTINATION "${_package_dir}")
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/mpmpbd-config.cmake.in"
  "${PROJECT_BINARY_DIR}/mpmpbd-config.cmake" INSTALL_DESTINATION "${_package_dir}")
# A header library fits every architecture; a compiled catalog does not.
if(NOT TARGET mpmpbd_catalog)
  set(_arch ARCH_INDEPENDENT)
endif()
write_basic_package_version_file("${PROJECT_BINARY_DIR}/mpmpbd-config-version.cmake"
  COMPATIBILITY SameMajorVersion ${_arch})
install(FILES
  "${PROJECT_BINARY_DIR}/mpmpbd-config.cmake"
  "${PROJECT_BINARY_DIR}/mpmpbd-config-version.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/MpmpbdFindCudaToolkit.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindRandom123.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindHdf5C.cmake"
  DESTINATION "${_package_dir}")

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_PACKAGE_NAME "libmpmpbd-dev")
  set(CPACK_PACKAGE_CONTACT "The mpmpbd authors")
  set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
  set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION "libdevel")
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libfmt-dev")
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "nlohmann-json3-dev, libtomlplusplus-dev, libstb-dev, librandom123-dev, libhdf5-dev, libdlpack-dev")
  include(CPack)
endif()
