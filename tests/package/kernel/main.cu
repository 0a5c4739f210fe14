#include <cuda_runtime.h>

#include <concepts>
#include <cstdio>
#include <mpmpbd/core/matrix.hpp>

template <std::floating_point T> __global__ void scale(mpmpbd::Mat3<T>* m, T s) {
  *m = s * mpmpbd::Mat3<T>::identity();
}

int main() {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::puts("no GPU: the kernel was compiled, not run");
    return 0;
  }
  mpmpbd::Mat3<float>* on_device = nullptr;
  mpmpbd::Mat3<float> on_host{};
  cudaMalloc(&on_device, sizeof(on_host));
  scale<<<1, 1>>>(on_device, 2.0f);
  cudaMemcpy(&on_host, on_device, sizeof(on_host), cudaMemcpyDeviceToHost);
  cudaFree(on_device);
  return on_host(2, 2) == 2.0f ? 0 : 1;
}
