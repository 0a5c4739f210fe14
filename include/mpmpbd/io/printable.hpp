// Text from a file as a message may show it: a control character would end the message or hide it.
#pragma once

#include <string>

namespace mpmpbd::io {

inline std::string printable(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace mpmpbd::io
