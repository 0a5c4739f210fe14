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
  int lattice_nodes;

  MPMPBD_HD int thread_points() const { return beads > 1 ? beads : 0; }
  MPMPBD_HD int points() const { return thread_points() + needle_points + attached_points; }
  template <class Shape> MPMPBD_HD int nodes() const {
    return touched_nodes > 0 ? touched_nodes : points() * nodes_per_point<Shape>;
  }
};

// What work memory is aligned to: a device loads so many bytes at once.
inline constexpr std::size_t work_alignment = 16;

// Memory nearer than the rest, such as the shared memory of a device, aligned as work memory is. There may be none, or too
// little: arrays that do not fit lie elsewhere.
struct FastMemory {
  char* first = nullptr;
  std::size_t bytes = 0;
};

namespace detail {

struct Cutter {
  char* memory;
  FastMemory fast{};
  std::size_t used = 0, fast_used = 0;

  template <class U> MPMPBD_HD U* cut(int count) {
    static_assert(alignof(U) <= work_alignment);
    std::size_t const at = place<U>(used);
    used = at + sizeof(U) * static_cast<std::size_t>(count);
    return array<U>(memory, at);
  }
  MPMPBD_HD void* cut_bytes(std::size_t bytes) {
    std::size_t const at = aligned(used);
    used = at + aligned(bytes);
    return array<char>(memory, at);
  }
  // From fast memory while there is room.
  template <class U> MPMPBD_HD U* cut_fast(int count) {
    std::size_t const at = place<U>(fast_used),
                      end = at + sizeof(U) * static_cast<std::size_t>(count);
    if (end > fast.bytes) return cut<U>(count);
    fast_used = end;
    return array<U>(fast.first, at);
  }
  // What is left of fast memory.
  MPMPBD_HD FastMemory fast_left() const {
    std::size_t const at = aligned(fast_used);
    if (at >= fast.bytes) return {};
    return {array<char>(fast.first, at), fast.bytes - at};
  }

 private:
  MPMPBD_HD static std::size_t aligned(std::size_t from) {
    return (from + work_alignment - 1) / work_alignment * work_alignment;
  }
  template <class U> MPMPBD_HD static std::size_t place(std::size_t from) {
    return (from + alignof(U) - 1) / alignof(U) * alignof(U);
  }
  template <class U> MPMPBD_HD static U* array(char* from, std::size_t at) {
    return from != nullptr ? reinterpret_cast<U*>(from + at) : nullptr;
  }
};

template <class T, class Form>
MPMPBD_HD Cutter cut_workspace(char* memory, FastMemory const& fast, ExchangeCapacity const& c,
                               ExchangeView<T, Form>& x) {
  Cutter cutter{memory, fast};
  int const per_point = nodes_per_point<typename Form::Shape>, pairs = c.points() * per_point;
  auto& t = x.thread_work;
  t.base = cutter.cut_fast<BeadRows<T, Form::bends>>(c.beads);
  t.rows = cutter.cut_fast<BeadRows<T, Form::bends>>(c.beads);
  t.chain.factors = cutter.cut_fast<BeadFactor<T, Form::bends>>(c.beads);
  t.chain.front = cutter.cut_fast<ChainFront<T, Form::bends>>(2);
  t.chain.end = cutter.cut_fast<EndFactor<T>>(1);
  t.head = cutter.cut_fast<ChainHead<T, Form::bends>>(1);
  t.alone = cutter.cut_fast<Column<T>>(2 * c.beads);
  t.trial = t.alone != nullptr ? t.alone + c.beads : nullptr;
  t.links = cutter.cut_fast<Link<T>>(c.beads);
  t.length = cutter.cut_fast<T>(c.beads);
  t.tangent = cutter.cut_fast<Vec3<T>>(c.beads);
  t.gap_speed = cutter.cut_fast<T>(c.beads);
  t.inertia = cutter.cut_fast<Vec3<T>>(c.beads);
  x.scratch = cutter.cut_fast<ExchangeScratch<T>>(1);
  x.work = cutter.cut_fast<PointWork<T>>(c.points());
  x.on = cutter.cut_fast<bool>(c.points());
  if constexpr (Form::bends) t.joints = cutter.cut_fast<Joint<T>>(c.beads);
  auto& i = x.incidence;
  i.node_capacity = c.nodes<typename Form::Shape>();
  i.point_capacity = c.points();
  i.per_point = per_point;
  i.touched.cut(cutter, c.lattice_nodes);
  i.entries = cutter.cut_fast<int>(1);
  i.weight = cutter.cut_fast<T>(pairs);
  i.slot = cutter.cut_fast<int>(pairs);
  i.pairs = cutter.cut_fast<int>(pairs);
  i.node = cutter.cut_fast<int>(pairs);
  i.nodes = cutter.cut_fast<TouchedNode<T>>(i.node_capacity);
  return cutter;
}

}  // namespace detail

// Bytes of work memory; it need not be kept or cleared between substeps.
template <class T, class Form> MPMPBD_HD std::size_t exchange_bytes(ExchangeCapacity const& c) {
  ExchangeView<T, Form> x{};
  return detail::cut_workspace<T, Form>(nullptr, {}, c, x).used;
}
// Bytes of fast memory that it can make use of.
template <class T, class Form>
MPMPBD_HD std::size_t exchange_fast_bytes(ExchangeCapacity const& c) {
  ExchangeView<T, Form> x{};
  FastMemory const all{nullptr, ~std::size_t{0}};
  return detail::cut_workspace<T, Form>(nullptr, all, c, x).fast_used;
}

// Points the work arrays of x into `memory` (exchange_bytes long, aligned to work_alignment), those that are waited for most
// into `fast`.
template <class T, class Form>
MPMPBD_HD void use_workspace(ExchangeView<T, Form>& x, ExchangeCapacity const& c, void* memory,
                             FastMemory const& fast = {}) {
  detail::cut_workspace<T, Form>(static_cast<char*>(memory), fast, c, x);
}

}  // namespace mpmpbd
