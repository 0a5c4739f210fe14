// The scene of tissue alone, compiled for CUDA devices.
#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/catalog/scenes.hpp>

template class mpmpbd::Simulation<mpmpbd::catalog::Tissue, mpmpbd::Cuda, float>;
