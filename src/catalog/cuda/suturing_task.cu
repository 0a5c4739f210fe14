// The suturing task with observations of state, compiled for CUDA devices: what has settings is compiled with the program.
// A step by itself is that of the suturing scene (suturing.cu); those of a decision are one launch.
#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/suturing/parts.hpp>

using Task = mpmpbd::rl::SeenByState<mpmpbd::rl::SuturingParts>;
extern template class mpmpbd::cuda::ResidentSteps<Task::Scene::Stepped, 512>;
extern template class mpmpbd::cuda::TiledSteps<Task::Scene::Stepped, float>;
template class mpmpbd::Simulation<Task::Scene, mpmpbd::Cuda, float>;
template class mpmpbd::rl::EpisodesOnDevice<Task, float>;
