// The scene of threads alone, compiled for CUDA devices.
#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/catalog/scenes.hpp>

template class mpmpbd::Simulation<mpmpbd::catalog::Suture, mpmpbd::Cuda, float>;
