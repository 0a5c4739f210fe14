// Copies from the memory of the emulated device that go on while a thread works.
#pragma once

#include <cuda_runtime.h>

inline void __pipeline_memcpy_async(void* to, void const* from, std::size_t bytes) {
  emulated::Block::running()->promise(to, from, bytes);
}
inline void __pipeline_commit() {}
inline void __pipeline_wait_prior(unsigned) { emulated::Block::running()->keep_promises(); }
