// The suturing task, compiled for every host back end in float.
#include <mpmpbd/catalog/suturing_task.hpp>

#define MPMPBD_CATALOG_DEFINE(TASK) MPMPBD_CATALOG_TASK(, TASK)
MPMPBD_CATALOG_TASKS(MPMPBD_CATALOG_DEFINE)
