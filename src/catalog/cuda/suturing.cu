// The suturing scene, compiled for CUDA devices.
#include <mpmpbd/backend/cuda/simulation.cuh>
#include <mpmpbd/catalog/suturing_scene.hpp>

template class mpmpbd::cuda::ResidentSteps<mpmpbd::Suturing::Stepped, 512>;
template class mpmpbd::cuda::TiledSteps<mpmpbd::Suturing::Stepped, float>;
template class mpmpbd::Simulation<mpmpbd::Suturing, mpmpbd::Cuda, float>;
