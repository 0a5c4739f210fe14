// Where the scenes of physics run: on the host, or on a GPU in the programs that tests/device makes of the same sources.
#pragma once

#include <cmath>

#ifdef MPMPBD_PHYSICS_ON_DEVICE
#include <mpmpbd/backend/cuda/simulation.cuh>
#else
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/backend/threads.hpp>
#endif

namespace test {

#ifdef MPMPBD_PHYSICS_ON_DEVICE
using BackEnd = mpmpbd::Cuda;
using ParallelBackEnd = mpmpbd::Cuda;
// What the momentum of a particle is rounded to when it is shared out, in its mass times a cell per substep.
template <class T> inline constexpr double quantum = 1 / double(mpmpbd::cuda::FixedPoint<T>::scale);
#else
using BackEnd = mpmpbd::Serial;
using ParallelBackEnd = mpmpbd::Threads;                 // for scenes that are large
template <class T> inline constexpr double quantum = 0;  // sums are floating point
#endif

// What this adds to a velocity, as a share of `speed` [m/s], on cells of dx [m] after some substeps of dt [s] in the mean of
// so many particles: half a count (one standard deviation) of each and in each, by lot; five standard deviations.
template <class T>
double share_of_counts(double speed, double dx, double dt, double substeps, double particles) {
  return 2.5 * quantum<T> * dx / dt / speed * std::sqrt(substeps / particles);
}

}  // namespace test
