// The suturing task with observations of state, compiled for CUDA devices: what has settings is compiled with the program.
#include <mpmpbd/rl/cuda/episodes.cuh>
#include <mpmpbd/rl/suturing/parts.hpp>

using Task = mpmpbd::rl::SeenByState<mpmpbd::rl::SuturingParts>;
template class mpmpbd::Simulation<Task::Scene, mpmpbd::Cuda, float>;
template class mpmpbd::rl::EpisodesOnDevice<Task, float>;
