// The end of a substep for one needle: its tip against the moved surface, its channels, the list of
// events.
#pragma once

#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/surface/channel.hpp>
#include <mpmpbd/surface/marker.hpp>

namespace mpmpbd {

// Call when needle and sheet have moved. `item` is the needle's slot in its view (all
// environments), `needle` its number within the environment. `impulse` is the axial impulse of the
// tip on the tissue in this substep [N s]; `entry` and `exit` are where the markers are now. All
// lanes of a group take part. Returns fault bits, which any lane may have met.
template <class Group_, class View, class Set, class Log, class S, class C, class T>
MPMPBD_HD std::uint32_t update_needle_surface(Group_ const& group, View const& view,
                                              std::int64_t item, std::int64_t needle,
                                              Vec3<T> const& tip_now, T impulse,
                                              Tick<T> const& tick, T time, S const& sheet,
                                              C const& columns, T dx, TipForces<T> const& forces,
                                              Vec3<T> const& entry, Vec3<T> const& exit,
                                              Set const& channels, Log const& log) {
  Tip<T> tip = Tip<T>::load(view, item);
  TipChange<T> const change =
      advance_tip(group, tip, tip_now, impulse, tick.dt, sheet, columns, dx, forces);
  std::uint32_t faults =
      change.faults | advance_channel(group, channels, needle, tip, change, sheet, dx);
  group.sync();  // all have loaded the tip
  group.one([&] {
    tip.store(view, item);
    if (change.kind == EventKind::none) return;
    T const miss = norm(change.position - (change.kind == EventKind::entry ? entry : exit));
    faults |= log.append(
        {change.kind, needle, change.mark, change.position, tick.step, time, change.force, miss});
  });
  return faults;
}

}  // namespace mpmpbd
