// How far fixed point may move what a device computes from what the host does.
#pragma once

#include <cmath>

namespace test {

// What the momentum of a particle is rounded to when it is shared out, in its mass times a cell per substep
// (backend/cuda/arena.cuh).
template <class T> inline constexpr double quantum_of_sums = sizeof(T) == 4 ? 0x1p-22 : 0x1p-44;

// In a particle's velocity [m/s], after some substeps of dt [s] on cells of dx [m]: each of the nodes of a particle holds
// about as many roundings of up to half a count, and counts for as much as the particle does in it; five standard
// deviations.
inline double fixed_point_noise(double dx, double dt, double substeps, int nodes = 27,
                                double quantum = quantum_of_sums<float>) {
  return 5.0 * nodes / std::sqrt(12.0) * quantum * std::sqrt(substeps) * dx / dt;
}

// In the mean of the velocities of particles [m/s]: rounded by lot, what a particle gives is off by up to half a count (one
// standard deviation) per substep, for itself (decision 24); five standard deviations.
inline double fixed_point_noise_of_mean(double dx, double dt, double substeps, double particles,
                                        double quantum = quantum_of_sums<float>) {
  return 2.5 * quantum * dx / dt * std::sqrt(substeps / particles);
}

}  // namespace test
