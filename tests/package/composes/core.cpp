#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/version.hpp>

int main() {
  auto const identity = mpmpbd::Mat3<double>::identity();
  return identity(1, 1) == 1.0 && MPMPBD_VERSION >= MPMPBD_MAKE_VERSION(0, 1, 0) ? 0 : 1;
}
