// Where the scenes of physics run: on the host, or on a GPU in the programs that tests/device makes of the same sources.
#pragma once

#ifdef MPMPBD_PHYSICS_ON_DEVICE
#include <mpmpbd/backend/cuda/simulation.cuh>
#else
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/backend/threads.hpp>
#endif

#include "cuda/fixed_point_noise.hpp"

namespace test {

// `quantum`: what sums of momentum are rounded to there.
#ifdef MPMPBD_PHYSICS_ON_DEVICE
using BackEnd = mpmpbd::Cuda;
using ParallelBackEnd = mpmpbd::Cuda;
template <class T> inline constexpr double quantum = quantum_of_sums<T>;
#else
using BackEnd = mpmpbd::Serial;
using ParallelBackEnd = mpmpbd::Threads;                 // for scenes that are large
template <class T> inline constexpr double quantum = 0;  // sums are floating point
#endif

}  // namespace test
