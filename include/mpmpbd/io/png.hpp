// Images as PNG files, through stb_image_write (Debian: libstb-dev) where it is present.
#pragma once

#include <cstdlib>

#include <mpmpbd/io/file.hpp>
#include <mpmpbd/render/image.hpp>

#if __has_include(<stb/stb_image_write.h>)
#define MPMPBD_HAS_PNG 1
// The implementation goes into a namespace of its own, so that a program may use stb itself as well;
// not inside of ours, whose abs() would hide that of C. The standard headers that it includes have to
// be known before.
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#pragma push_macro("STB_IMAGE_WRITE_IMPLEMENTATION")
#pragma push_macro("STB_IMAGE_WRITE_STATIC")
#pragma push_macro("INCLUDE_STB_IMAGE_WRITE_H")
#pragma push_macro("STBIWDEF")
#undef STB_IMAGE_WRITE_IMPLEMENTATION
#undef STB_IMAGE_WRITE_STATIC
#undef INCLUDE_STB_IMAGE_WRITE_H
#undef STBIWDEF
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
namespace mpmpbd_stb {
#include <stb/stb_image_write.h>
}
#pragma pop_macro("STBIWDEF")
#pragma pop_macro("INCLUDE_STB_IMAGE_WRITE_H")
#pragma pop_macro("STB_IMAGE_WRITE_STATIC")
#pragma pop_macro("STB_IMAGE_WRITE_IMPLEMENTATION")
#else
#define MPMPBD_HAS_PNG 0
#endif

namespace mpmpbd::io {

// Writes the colours of the image as an RGB PNG.
inline void write_png(Path const& path, render::Image const& image) {
  if (image.width <= 0 || image.height <= 0)
    throw FileError(
        fmt::format("cannot write '{}': the image has {} x {} pixels; draw something into it first",
                    path.string(), image.width, image.height));
#if MPMPBD_HAS_PNG
  OutputFile file(path);
  int length = 0;
  unsigned char* const png = mpmpbd_stb::stbi_write_png_to_mem(
      image.rgb.data(), 3 * image.width, image.width, image.height, 3, &length);
  if (png == nullptr)
    throw FileError(fmt::format("cannot write '{}': out of memory", path.string()));
  std::string const bytes(reinterpret_cast<char const*>(png), std::size_t(length));
  std::free(png);
  file.write(bytes);
  file.commit();
#else
  throw FileError(fmt::format(
      "cannot write '{}': this program was built without stb_image_write; install libstb-dev and build again",
      path.string()));
#endif
}

}  // namespace mpmpbd::io
