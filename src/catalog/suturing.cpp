// The suturing scene, compiled for every host back end and precision.
#include <mpmpbd/catalog.hpp>

MPMPBD_CATALOG_SIMULATIONS(, mpmpbd::Suturing)
