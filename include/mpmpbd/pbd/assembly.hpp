// A rod under construction, on the host and in double: beads, frames and constraint instances, checked one
// by one, then coloured and written into the tables of a simulation.
#pragma once

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/pbd/body.hpp>
#include <mpmpbd/pbd/coloring.hpp>

namespace mpmpbd {

namespace detail {
// What constraint C acts on within a rod: for each of its beads and frames, in order, whether it is a frame.
template <class C>
inline constexpr auto is_frame_slot = []<class... Us>(TypeList<Us...>) {
  std::array<bool, static_cast<std::size_t>((int(is_kept<Us>) + ...))> frame{};
  std::size_t n = 0;
  ((is_kept<Us> ? void(frame[n++] = std::is_same_v<Us, unknown::Orientation>) : void()), ...);
  return frame;
}(typename C::Unknowns{});

template <class C> struct InstanceList {
  static constexpr std::size_t size = std::size(is_frame_slot<C>);
  using Slots = std::array<std::int64_t, size>;
  std::vector<Slots> slots;
  std::vector<parameters_t<C, double>> parameters;
};
}  // namespace detail

// The order in which Gauss-Seidel visits the instances of a kind.
enum class VisitOrder {
  coloured,  // few colours, each of many instances that lanes can share
  along,  // one by one in the order in which they were added: no parallel work, but the classical sweep
};

// What one environment holds of the rods of `Body` (a Pbd<...>).
template <class Body> class RodAssembly {
 public:
  using Set = typename Body::Set;

  std::int64_t beads() const { return static_cast<std::int64_t>(positions_.size()); }
  std::int64_t frames() const { return static_cast<std::int64_t>(frames_.size()); }
  template <class C> std::int64_t instances() const {
    return static_cast<std::int64_t>(of<C>().slots.size());
  }
  Vec3<double> const& position(std::int64_t b) const {
    return positions_[static_cast<std::size_t>(b)];
  }
  double inverse_mass(std::int64_t b) const { return inverse_masses_[static_cast<std::size_t>(b)]; }
  Quaternion<double> const& orientation(std::int64_t f) const {
    return frames_[static_cast<std::size_t>(f)].orientation;
  }

  // Adds a bead: position [m], mass [kg], velocity [m/s]. Returns its number.
  std::int64_t add_bead(Vec3<double> const& x, double mass, Vec3<double> const& v = {}) {
    check_parameter("RodAssembly::add_bead", bound::positive("mass", "kg"), mass);
    check_vector("RodAssembly::add_bead", bound::any("position", "m"), x);
    check_vector("RodAssembly::add_bead", bound::any("velocity", "m/s"), v);
    positions_.push_back(x);
    velocities_.push_back(v);
    inverse_masses_.push_back(1.0 / mass);
    return beads() - 1;
  }
  // Prescribes a bead's motion: it keeps its velocity [m/s] whatever pulls at it.
  void prescribe(std::int64_t b, Vec3<double> const& velocity = {}) {
    check_bead("prescribe", b);
    check_vector("RodAssembly::prescribe", bound::any("velocity", "m/s"), velocity);
    inverse_masses_[static_cast<std::size_t>(b)] = 0.0;
    velocities_[static_cast<std::size_t>(b)] = velocity;
  }
  void set_mass(std::int64_t b, double mass) {
    check_bead("set_mass", b);
    check_parameter("RodAssembly::set_mass", bound::positive("mass", "kg"), mass);
    inverse_masses_[static_cast<std::size_t>(b)] = 1.0 / mass;
  }

  // Adds the frame of a segment: orientation (w, x, y, z), inertia [kg m^2], angular velocity in world axes
  // [rad/s]. Returns its number.
  std::int64_t add_frame(Quaternion<double> const& q, double inertia, Vec3<double> const& w = {}) {
    static_assert(
        Body::has_frames,
        "mpmpbd RodAssembly: no constraint of this rod acts on frames; write StretchShear and BendTwist into its Constraints<...>");
    check_parameter("RodAssembly::add_frame", bound::positive("inertia", "kg m^2"), inertia);
    check_vector("RodAssembly::add_frame", bound::any("angular velocity", "rad/s"), w);
    frames_.push_back({quaternion::checked("RodAssembly::add_frame", q), w, 1.0 / inertia});
    return frames() - 1;
  }
  // Prescribes a frame's motion: it keeps its angular velocity, in world axes [rad/s], whatever turns it.
  void prescribe_frame(std::int64_t f, Vec3<double> const& angular_velocity = {}) {
    check_frame("prescribe_frame", f);
    check_vector("RodAssembly::prescribe_frame", bound::any("angular velocity", "rad/s"),
                 angular_velocity);
    frames_[static_cast<std::size_t>(f)].inverse_inertia = 0.0;
    frames_[static_cast<std::size_t>(f)].angular_velocity = angular_velocity;
  }

  // Adds an instance of constraint C between beads and frames that exist and differ, given in the order of
  // its unknowns.
  template <class C>
  void add(typename detail::InstanceList<C>::Slots const& slots, parameters_t<C, double> const& k) {
    static_assert(
        Set::template has<C>,
        "mpmpbd RodAssembly: this constraint is not in the rod's set; write it into Constraints<...>");
    check_parameters<C, double>(k);
    constexpr auto is_frame = detail::is_frame_slot<C>;
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (is_frame[i])
        check_frame(C::name.view(), slots[i]);
      else
        check_bead(C::name.view(), slots[i]);
      std::string const what = is_frame[i] ? "frame" : "bead";
      for (std::size_t j = 0; j < i; ++j)
        refuse_if(is_frame[i] == is_frame[j] && slots[i] == slots[j], C::name.view(),
                  "acts on " + what + " " + std::to_string(slots[i]) + " twice; give different " +
                      what + "s");
    }
    if constexpr (detail::needs_chain<typename Body::Solver>) check_chain<C>(slots);
    of<C>().slots.push_back(slots);
    of<C>().parameters.push_back(k);
  }

  // Slots that each domain needs, for SimulationOptions::capacity.
  std::vector<Capacity> capacity() const {
    std::vector<Capacity> all{{Beads::name.view(), beads()}};
    if constexpr (Body::has_frames) all.push_back({Frames::name.view(), frames()});
    for_each_type(typename Set::List{}, [&]<class C>(std::type_identity<C>) {
      all.push_back({C::name.view(), instances<C>()});
    });
    return all;
  }

  // Writes everything into environment `env` of a store (core/state.hpp), instances ordered by colour. Beads and
  // frames begin without what a coupling has stored with them; contact points are the caller's. Too small a
  // capacity throws std::out_of_range and nothing is written.
  template <class Store>
  void write(Store& store, std::int64_t env, VisitOrder visit = VisitOrder::coloured) const {
    using T = typename Store::Scalar;
    check_room(store, env);
    auto& table = store.template table<Beads>();
    table.clear(env, 0, table.capacity());
    table.set_live(env, beads());
    for (std::int64_t b = 0; b < beads(); ++b) {
      auto const i = static_cast<std::size_t>(b);
      table.template set<bead::Position>(env, b, cast<T>(positions_[i]));
      table.template set<bead::Velocity>(env, b, cast<T>(velocities_[i]));
      table.template set<bead::InverseMass>(env, b, T(inverse_masses_[i]));
      table.template set<bead::Previous>(env, b, cast<T>(positions_[i]));
    }
    if constexpr (Body::has_frames) write_frames(store, env);
    for_each_type(typename Set::List{},
                  [&]<class C>(std::type_identity<C>) { write_instances<C>(store, env, visit); });
  }

 private:
  template <class Store> void check_room(Store const& store, std::int64_t env) const {
    store.template table<Beads>().check_live(env, beads());
    if constexpr (Body::has_frames) store.template table<Frames>().check_live(env, frames());
    for_each_type(typename Set::List{}, [&]<class C>(std::type_identity<C>) {
      store.template table<Instances<C>>().check_live(env, instances<C>());
    });
  }

  template <class C> struct Held { detail::InstanceList<C> list; };
  template <class List> struct AllOf;
  template <class... Cs> struct AllOf<TypeList<Cs...>> : Held<Cs>... {};

  template <class C> auto& of() { return static_cast<Held<C>&>(all_).list; }
  template <class C> auto const& of() const { return static_cast<Held<C> const&>(all_).list; }

  static void refuse_if(bool bad, std::string_view owner, std::string const& sentence) {
    if (bad)
      throw std::invalid_argument("mpmpbd RodAssembly, " + std::string(owner) + ": " + sentence);
  }
  static void check_vector(std::string_view owner, ParameterInfo const& info,
                           Vec3<double> const& v) {
    for (int a = 0; a < 3; ++a) check_parameter(owner, info, v[a]);
  }
  void check_bead(std::string_view owner, std::int64_t b) const {
    refuse_if(b < 0 || b >= beads(), owner,
              "bead " + std::to_string(b) + " does not exist; the rod has beads 0 to " +
                  std::to_string(beads() - 1));
  }
  void check_frame(std::string_view owner, std::int64_t f) const {
    refuse_if(f < 0 || f >= frames(), owner,
              "frame " + std::to_string(f) + " does not exist; the rod has frames 0 to " +
                  std::to_string(frames() - 1));
  }
  template <class C> void check_chain(typename detail::InstanceList<C>::Slots const& slots) const {
    constexpr auto is_frame = detail::is_frame_slot<C>;
    for (std::size_t i = 1; i < slots.size(); ++i)
      refuse_if(
          is_frame[i] == is_frame[i - 1] && slots[i] != slots[i - 1] + 1, C::name.view(),
          (is_frame[i] ? "frames " : "beads ") + std::to_string(slots[i - 1]) + ", " +
              std::to_string(slots[i]) +
              " do not follow each other, which a direct solver needs; number them along the thread, or take Xpbd<8>");
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (i > 0 && is_frame[i] == is_frame[i - 1])
        continue;  // neighbours share what follows the first
      for (auto const& other : of<C>().slots)
        refuse_if(other[i] == slots[i], C::name.view(),
                  std::string("given twice at ") + (is_frame[i] ? "frame " : "bead ") +
                      std::to_string(slots[i]) + "; a direct solver takes one there");
    }
  }

  template <class Store> void write_frames(Store& store, std::int64_t env) const {
    using T = typename Store::Scalar;
    auto& table = store.template table<Frames>();
    table.clear(env, 0, table.capacity());
    table.set_live(env, frames());
    for (std::int64_t f = 0; f < frames(); ++f) {
      auto const& one = frames_[static_cast<std::size_t>(f)];
      table.template set<frame::Orientation>(env, f, cast<T>(one.orientation));
      table.template set<frame::AngularVelocity>(env, f, cast<T>(one.angular_velocity));
      table.template set<frame::InverseInertia>(env, f, T(one.inverse_inertia));
      table.template set<frame::Previous>(env, f, cast<T>(one.orientation));
    }
  }

  // The instances of C with frames numbered after the beads.
  template <class C> auto numbered() const {
    auto all = of<C>().slots;
    for (auto& one : all)
      for (std::size_t i = 0; i < one.size(); ++i)
        if (detail::is_frame_slot<C>[i]) one[i] += beads();
    return all;
  }
  // The beads, or the frames, of an instance, if it has any.
  template <class C, class Index, bool frames, class Table>
  static void write_index(Table& table, std::int64_t env, std::int64_t slot,
                          typename detail::InstanceList<C>::Slots const& slots) {
    if constexpr (contains<typename instance<C>::List, Index>) {
      Vec<std::int64_t, Index::components> index{};
      int n = 0;
      for (std::size_t i = 0; i < slots.size(); ++i)
        if (detail::is_frame_slot<C>[i] == frames) index[n++] = slots[i];
      if constexpr (Index::components == 1)
        table.template set<Index>(env, slot, index[0]);
      else
        table.template set<Index>(env, slot, index);
    }
  }

  template <class C, class Store>
  void write_instances(Store& store, std::int64_t env, VisitOrder visit) const {
    using T = typename Store::Scalar;
    using Its = instance<C>;
    auto const& list = of<C>();
    auto colours = colour_greedily(numbered<C>(), beads() + frames());
    if (visit == VisitOrder::along) std::iota(colours.begin(), colours.end(), 0);
    std::vector<std::size_t> order(list.slots.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return colours[a] < colours[b]; });
    auto& table = store.template table<Instances<C>>();
    table.set_live(env, static_cast<std::int64_t>(order.size()));
    std::int64_t end = static_cast<std::int64_t>(order.size());
    for (std::size_t slot = order.size(); slot-- > 0;) {
      std::size_t const from = order[slot];
      auto const s = static_cast<std::int64_t>(slot);
      if (slot + 1 < order.size() && colours[from] != colours[order[slot + 1]]) end = s + 1;
      table.template set<typename Its::ColourEnd>(env, s, end);
      write_index<C, typename Its::Index, false>(table, env, s, list.slots[from]);
      write_index<C, typename Its::FrameIndex, true>(table, env, s, list.slots[from]);
      if constexpr (parameter_count < C >> 0) {
        auto const* numbers = reinterpret_cast<double const*>(&list.parameters[from]);
        value_t<typename Its::Parameters, T> flat{};
        if constexpr (parameter_count<C> == 1)
          flat = T(numbers[0]);
        else
          for (int i = 0; i < static_cast<int>(parameter_count<C>); ++i) flat[i] = T(numbers[i]);
        table.template set<typename Its::Parameters>(env, s, flat);
      }
      table.template set<typename Its::Multiplier>(env, s, {});
    }
  }

  struct Frame {
    Quaternion<double> orientation;
    Vec3<double> angular_velocity;
    double inverse_inertia;
  };
  std::vector<Frame> frames_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<double> inverse_masses_;
  AllOf<typename Set::List> all_;
};

}  // namespace mpmpbd
