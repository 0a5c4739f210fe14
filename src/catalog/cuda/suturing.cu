// The suturing scene, compiled for CUDA devices.
#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/catalog/suturing_scene.hpp>

template class mpmpbd::Simulation<mpmpbd::Suturing, mpmpbd::Cuda, float>;
