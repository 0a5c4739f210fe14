// The exchange of a rig where tests of physics run.
#pragma once

#include "physics/back_end.hpp"

#ifdef MPMPBD_PHYSICS_ON_DEVICE
#include "coupling/exchange_on_device.cuh"
#else
#include "coupling/rig.hpp"
#endif

namespace test {

// As mpmpbd::exchange, of a view x whose workspace begins at `memory`.
template <class AnyRig, class View>
std::uint32_t exchange_on_back_end(AnyRig& rig, View const& x, [[maybe_unused]] char* memory,
                                   int sweeps = 2) {
#ifdef MPMPBD_PHYSICS_ON_DEVICE
  return exchange_on_device(rig, x, memory, sweeps);
#else
  return mpmpbd::exchange(mpmpbd::Solo{}, x, rig.nodes(), sweeps);
#endif
}
// Of the rig's own view.
template <class AnyRig, class View>
std::uint32_t exchange_on_back_end(AnyRig& rig, View const& x, int sweeps = 2) {
  return exchange_on_back_end(rig, x, rig.memory.data(), sweeps);
}
// As rig.couple().
template <class AnyRig> std::uint32_t couple_on_back_end(AnyRig& rig) {
  return rig.couple(0.25, [](AnyRig& r, auto const& x) { return exchange_on_back_end(r, x); });
}

}  // namespace test
