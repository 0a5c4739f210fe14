// Summaries (JSON) under libFuzzer: see entries.hpp.
#include "entries.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* bytes, std::size_t size) {
  fuzz::summary_file({reinterpret_cast<char const*>(bytes), size});
  return 0;
}
