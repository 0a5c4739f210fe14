// The optional after_update of a material that wraps another one.
#pragma once

#include <mpmpbd/mpm/concepts.hpp>

namespace mpmpbd::detail {

// Outer derives from this; it has after_update exactly when Inner has. Outer::inner(p, k) gives Inner's
// parameters.
template <class Outer, class Inner, bool = UpdatesHistory<Inner>> struct ForwardsUpdate {};
template <class Outer, class Inner> struct ForwardsUpdate<Outer, Inner, true> {
  template <class P, class K, class T>
  MPMPBD_HD static void after_update(P& p, K const& k, Tick<T> const& tick) {
    Inner::after_update(p, Outer::inner(p, k), tick);
  }
};

}  // namespace mpmpbd::detail
