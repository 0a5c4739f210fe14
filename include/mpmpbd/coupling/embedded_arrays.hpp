// The compact arrays that `Embedded` works on during a substep, cut from one block of scratch memory.
#pragma once

#include <mpmpbd/coupling/workspace.hpp>
#include <mpmpbd/surface/channel.hpp>
#include <mpmpbd/surface/columns.hpp>

namespace mpmpbd {

// How much of everything one environment has; 0 for what its scene does not name.
struct BodyCounts {
  int beads = 0;
  int needle_points = 0;  // the tip's axial point included
  int attached_points = 0;
  std::int64_t triangles = 0;
  int vertices = 0;
  int column_count[2] = {0, 0};
  int lattice_nodes = 0;
  bool overflow = false;  // something was left out

  // Leaves out what has no place among so many contact points: attachments first, then the needle from its blunt end on, then
  // the thread, which is moved as a whole or not at all, and with it what is attached to it. A needle without points is absent,
  // and no thread is tied to it.
  MPMPBD_HD void fit(std::int64_t places) {
    BodyCounts const all = *this;
    auto const left = [&] { return static_cast<int>(places - exchange().thread_points()); };
    if (left() < 0) beads = 0;
    if (beads < 2) attached_points = 0;  // they are places on a segment
    needle_points = min(needle_points, left());
    attached_points = min(attached_points, left() - needle_points);
    overflow = beads < all.beads || needle_points < all.needle_points ||
               attached_points < all.attached_points;
  }

  MPMPBD_HD ExchangeCapacity exchange() const {
    return {beads, needle_points, attached_points, 0, lattice_nodes};
  }
  MPMPBD_HD std::int64_t columns() const {
    return static_cast<std::int64_t>(column_count[0]) * column_count[1];
  }
  // A triangle of about a cell lies over a few columns; large ones of a coarse sheet over more.
  MPMPBD_HD std::int64_t column_items() const { return 16 * triangles + 4 * columns(); }
};

struct IntegerRow {
  int* data;
  MPMPBD_HD std::int64_t operator()(std::int64_t i) const { return data[i]; }
  MPMPBD_HD void set(std::int64_t i, std::int64_t v) const { data[i] = static_cast<int>(v); }
  MPMPBD_HD int& entry(std::int64_t i) const { return data[i]; }
};

template <class T, class Form> struct EmbeddedArrays {
  // First, so that they stay in place between substeps: the triangles over the columns, where vertices were along x and y when
  // these were listed [m], and how many have moved too far since.
  IntegerRow column_first, column_item;
  Vec<T, 2>* listed_at;
  int* moved_vertices;
  Vec3<T>* position;
  Vec3<T>* velocity;
  T* mass;
  bool* known;
  T* rest_length;
  T* rest_angle;
  T* impulse;
  ContactPoint<T>* points;
  ThreadPlace<T>* aside;  // of every bead: before, after; with a surface, as what follows
  Following* following;   // by ChannelOrder
  RigidBody<T>* needle;
  ExchangeView<T, Form>* view;  // one for all lanes: a device would keep a copy for each, far away
  void* exchange;
  FastMemory exchange_fast{};  // braced: nvcc takes an implied constructor for the host's

  // Cuts the arrays from `memory` (null: only measures), those that live for a substep from fast memory where there is some.
  // Returns how much of both is used.
  MPMPBD_HD detail::Cutter cut(void* memory, BodyCounts const& n, FastMemory const& fast = {}) {
    detail::Cutter cutter{static_cast<char*>(memory), fast};
    column_first = {cutter.cut<int>(static_cast<int>(n.columns() + 1))};
    column_item = {cutter.cut<int>(static_cast<int>(n.column_items()))};
    listed_at = cutter.cut<Vec<T, 2>>(n.vertices);
    moved_vertices = cutter.cut<int>(1);
    view = cutter.cut_fast<ExchangeView<T, Form>>(1);
    position = cutter.cut_fast<Vec3<T>>(n.beads);
    velocity = cutter.cut_fast<Vec3<T>>(n.beads);
    mass = cutter.cut_fast<T>(n.beads);
    known = cutter.cut_fast<bool>(n.beads);
    rest_length = cutter.cut_fast<T>(n.beads);
    rest_angle = cutter.cut_fast<T>(n.beads);
    impulse = cutter.cut_fast<T>(n.beads);
    points = cutter.cut_fast<ContactPoint<T>>(n.exchange().points());
    needle = cutter.cut_fast<RigidBody<T>>(1);
    bool const surface = n.columns() > 0;
    aside = cutter.cut<ThreadPlace<T>>(surface ? 2 * n.beads : 0);
    following = cutter.cut<Following>(surface ? ChannelOrder{n.beads, n.needle_points}.count() : 0);
    exchange = cutter.cut_bytes(exchange_bytes<T, Form>(n.exchange()));
    exchange_fast = cutter.fast_left();
    return cutter;
  }
};

}  // namespace mpmpbd
