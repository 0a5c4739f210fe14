// One block of memory for all work arrays of an exchange, cut up in a fixed order.
#pragma once

#include <cstddef>

#include <mpmpbd/coupling/exchange.hpp>

namespace mpmpbd {

// How much an environment can hold; fixed when the simulation is made. `touched_nodes` = 0: as many as the
// points can touch, so that it cannot overflow.
struct ExchangeCapacity {
  int beads, needle_points, attached_points;
  int touched_nodes;

  MPMPBD_HD int thread_points() const { return beads > 1 ? beads : 0; }
  MPMPBD_HD int points() const { return thread_points() + needle_points + attached_points; }
  template <class Shape> MPMPBD_HD int nodes() const {
    return touched_nodes > 0 ? touched_nodes : points() * nodes_per_point<Shape>;
  }
};

namespace detail {

struct Cutter {
  char* memory;
  std::size_t used = 0;
  template <class U> MPMPBD_HD U* cut(int count) {
    used = (used + alignof(U) - 1) / alignof(U) * alignof(U);
    U* const first = memory != nullptr ? reinterpret_cast<U*>(memory + used) : nullptr;
    used += sizeof(U) * static_cast<std::size_t>(count);
    return first;
  }
};

template <class T, class Form>
MPMPBD_HD std::size_t cut_workspace(char* memory, ExchangeCapacity const& c,
                                    ExchangeView<T, Form>& x) {
  Cutter cutter{memory};
  int const per_point = nodes_per_point<typename Form::Shape>, pairs = c.points() * per_point;
  auto& t = x.thread_work;
  t.base = cutter.cut<BeadBlocks<T, Form::bends>>(c.beads);
  t.blocks = cutter.cut<BeadBlocks<T, Form::bends>>(c.beads);
  t.factors = cutter.cut<BeadFactor<T, Form::bends>>(c.beads);
  t.links = cutter.cut<Link<T>>(c.beads);
  t.length = cutter.cut<T>(c.beads);
  t.tangent = cutter.cut<Vec3<T>>(c.beads);
  t.gap_speed = cutter.cut<T>(c.beads);
  t.inertia = cutter.cut<Vec3<T>>(c.beads);
  t.trial = cutter.cut<Vec3<T>>(c.beads);
  t.trial_impulse = cutter.cut<T>(c.beads);
  t.alone = cutter.cut<Vec3<T>>(c.beads);
  t.alone_impulse = cutter.cut<T>(c.beads);
  t.head = cutter.cut<ChainHead<T, Form::bends>>(1);
  t.reduced = cutter.cut<Vec3<T>>(c.beads);
  t.reduced_impulse = cutter.cut<T>(c.beads);
  if constexpr (Form::bends) t.joints = cutter.cut<Joint<T>>(c.beads);
  auto& i = x.incidence;
  i.node_capacity = c.nodes<typename Form::Shape>();
  i.point_capacity = c.points();
  i.per_point = per_point;
  i.weight = cutter.cut<T>(pairs);
  i.node = cutter.cut<int>(pairs);
  i.slot = cutter.cut<int>(pairs);
  i.pairs = cutter.cut<int>(pairs);
  i.nodes = cutter.cut<TouchedNode<T>>(i.node_capacity);
  i.counters = cutter.cut<int>(2);
  x.work = cutter.cut<PointWork<T>>(c.points());
  x.on = cutter.cut<bool>(c.points());
  x.scratch = cutter.cut<ExchangeScratch<T>>(1);
  return cutter.used;
}

}  // namespace detail

// Bytes of work memory; it need not be kept or cleared between substeps.
template <class T, class Form> MPMPBD_HD std::size_t exchange_bytes(ExchangeCapacity const& c) {
  ExchangeView<T, Form> x{};
  return detail::cut_workspace<T, Form>(nullptr, c, x);
}

// Points the work arrays of x into `memory` (exchange_bytes long, aligned for double). `slot_of_node` has
// one int per lattice node, all -1 before the first exchange; every exchange leaves it so.
template <class T, class Form>
MPMPBD_HD void use_workspace(ExchangeView<T, Form>& x, ExchangeCapacity const& c, void* memory,
                             int* slot_of_node) {
  detail::cut_workspace<T, Form>(static_cast<char*>(memory), c, x);
  x.incidence.slot_of_node = slot_of_node;
}

}  // namespace mpmpbd
