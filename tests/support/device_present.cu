// Exit status 0 if a GPU can be used, 1 if not.
#include <cuda_runtime.h>

int main() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0 ? 0 : 1;
}
