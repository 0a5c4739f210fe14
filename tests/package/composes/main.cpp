#include <fmt/core.h>

#include <Eigen/Core>
#include <mpmpbd/core/matrix.hpp>
#include <mpmpbd/version.hpp>

int main() {
  auto const ours = mpmpbd::Mat3<double>::identity();
  Eigen::Map<Eigen::Matrix3d const> const theirs(ours.m);
  fmt::print("mpmpbd {}: trace {}\n", MPMPBD_VERSION_STRING, theirs.trace());
  return theirs.trace() == 3.0 ? 0 : 1;
}
