// How far fixed point may move what a device computes from what the host does.
#pragma once

#include <cmath>

namespace test {

inline constexpr double fixed_point_scale =
    0x1p22;  // counts, of a float run (backend/cuda/arena.cuh)

// In a particle's velocity [m/s], after some substeps of dt [s] on cells of dx [m]: each of the nodes of a particle holds
// about as many roundings of up to half a count, and counts for as much as the particle does in it; five standard
// deviations.
inline double fixed_point_noise(double dx, double dt, double substeps, int nodes = 27) {
  return 5.0 * nodes / std::sqrt(12.0) / fixed_point_scale * std::sqrt(substeps) * dx / dt;
}

// In the mean of the velocities of particles [m/s]: rounded by lot, what a particle gives is off by up to half a count (one
// standard deviation) per substep, for itself (decision 24); five standard deviations.
inline double fixed_point_noise_of_mean(double dx, double dt, double substeps, double particles) {
  return 2.5 * dx / dt / fixed_point_scale * std::sqrt(substeps / particles);
}

}  // namespace test
