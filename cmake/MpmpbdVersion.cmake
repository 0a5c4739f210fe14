# version.hpp is what users test against and project(VERSION) is what find_package compares: they
# have to say the same.
set(_header "${PROJECT_SOURCE_DIR}/include/mpmpbd/version.hpp")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${_header}")
file(READ "${_header}" _text)
foreach(_part IN ITEMS MAJOR MINOR PATCH)
  string(REGEX MATCH "#define MPMPBD_VERSION_${_part} ([0-9]+)" _ "${_text}")
  if(NOT "${CMAKE_MATCH_1}" STREQUAL "${PROJECT_VERSION_${_part}}")
    message(FATAL_ERROR
      "mpmpbd: MPMPBD_VERSION_${_part} in ${_header} is '${CMAKE_MATCH_1}', but project(VERSION) "
      "says '${PROJECT_VERSION_${_part}}'; make them equal")
  endif()
endforeach()
string(FIND "${_text}" "#define MPMPBD_VERSION_STRING \"${PROJECT_VERSION}\"" _at)
if(_at EQUAL -1)
  message(FATAL_ERROR
    "mpmpbd: MPMPBD_VERSION_STRING in ${_header} is not \"${PROJECT_VERSION}\"; make it equal to "
    "project(VERSION)")
endif()
