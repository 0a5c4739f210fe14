#include "catch.hpp"

#include <string>

#include <mpmpbd/version.hpp>

TEST_CASE("the version string is made of the version numbers", "[version]") {
  REQUIRE(MPMPBD_VERSION_STRING == std::to_string(MPMPBD_VERSION_MAJOR) + "." +
                                       std::to_string(MPMPBD_VERSION_MINOR) + "." +
                                       std::to_string(MPMPBD_VERSION_PATCH));
}

TEST_CASE("versions are ordered as numbers", "[version]") {
  STATIC_REQUIRE(MPMPBD_VERSION >= MPMPBD_MAKE_VERSION(0, 1, 0));
  STATIC_REQUIRE(MPMPBD_MAKE_VERSION(0, 2, 0) > MPMPBD_MAKE_VERSION(0, 1, 999));
  STATIC_REQUIRE(MPMPBD_MAKE_VERSION(1, 0, 0) > MPMPBD_MAKE_VERSION(0, 999, 999));
}
