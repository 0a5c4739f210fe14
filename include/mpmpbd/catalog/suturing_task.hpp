// The suturing task, compiled once in mpmpbd::catalog for Serial and Threads in float.
//
// Including this instead of rl/suturing/task.hpp saves the compile time of its scene.
#pragma once

#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/rl/suturing/task.hpp>
#include <mpmpbd/rl/vector_env.hpp>

// Applies a macro to every task of the catalogue. `M(Task)`.
#define MPMPBD_CATALOG_TASKS(M) \
  M(mpmpbd::rl::SuturingTask)   \
  M(mpmpbd::rl::SuturingFromPictures)

#define MPMPBD_CATALOG_TASK(KEYWORD, TASK)                                                \
  KEYWORD template class mpmpbd::Simulation<typename TASK::Scene, mpmpbd::Serial, float>; \
  KEYWORD template class mpmpbd::Simulation<typename TASK::Scene, mpmpbd::Threads, float>;

#define MPMPBD_CATALOG_DECLARE(TASK) MPMPBD_CATALOG_TASK(extern, TASK)
MPMPBD_CATALOG_TASKS(MPMPBD_CATALOG_DECLARE)
#undef MPMPBD_CATALOG_DECLARE
