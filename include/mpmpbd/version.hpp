// The version of the library. The build refuses to configure when it differs from the project's.
#pragma once

#define MPMPBD_VERSION_MAJOR 0
#define MPMPBD_VERSION_MINOR 1
#define MPMPBD_VERSION_PATCH 0

#define MPMPBD_VERSION_STRING "0.1.0"

// One number to compare with: MPMPBD_VERSION >= MPMPBD_MAKE_VERSION(0, 1, 0).
#define MPMPBD_MAKE_VERSION(major, minor, patch) ((major)*1000000 + (minor)*1000 + (patch))
#define MPMPBD_VERSION \
  MPMPBD_MAKE_VERSION(MPMPBD_VERSION_MAJOR, MPMPBD_VERSION_MINOR, MPMPBD_VERSION_PATCH)
