// A rod under construction, on the host and in double: beads and constraint instances, checked one by
// one, then coloured and written into the tables of a simulation.
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
template <class C> struct InstanceList {
  static constexpr std::size_t points = static_cast<std::size_t>(point_count<C>);
  std::vector<std::array<std::int64_t, points>> beads;
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
  template <class C> std::int64_t instances() const {
    return static_cast<std::int64_t>(of<C>().beads.size());
  }
  Vec3<double> const& position(std::int64_t b) const {
    return positions_[static_cast<std::size_t>(b)];
  }
  double inverse_mass(std::int64_t b) const { return inverse_masses_[static_cast<std::size_t>(b)]; }

  // Adds a bead: position [m], mass [kg], velocity [m/s]. Returns its number.
  std::int64_t add_bead(Vec3<double> const& x, double mass, Vec3<double> const& v = {}) {
    check_parameter("RodAssembly::add_bead", bound::positive("mass", "kg"), mass);
    for (int a = 0; a < 3; ++a) {
      check_parameter("RodAssembly::add_bead", bound::any("position", "m"), x[a]);
      check_parameter("RodAssembly::add_bead", bound::any("velocity", "m/s"), v[a]);
    }
    positions_.push_back(x);
    velocities_.push_back(v);
    inverse_masses_.push_back(1.0 / mass);
    return beads() - 1;
  }
  // Prescribes a bead's motion: it keeps its velocity whatever pulls at it.
  void prescribe(std::int64_t b, Vec3<double> const& velocity = {}) {
    check_bead("prescribe", b);
    inverse_masses_[static_cast<std::size_t>(b)] = 0.0;
    velocities_[static_cast<std::size_t>(b)] = velocity;
  }
  void set_mass(std::int64_t b, double mass) {
    check_bead("set_mass", b);
    check_parameter("RodAssembly::set_mass", bound::positive("mass", "kg"), mass);
    inverse_masses_[static_cast<std::size_t>(b)] = 1.0 / mass;
  }

  // Adds an instance of constraint C between beads that exist and differ.
  template <class C>
  void add(std::array<std::int64_t, detail::InstanceList<C>::points> const& beads,
           parameters_t<C, double> const& k) {
    static_assert(
        Set::template has<C>,
        "mpmpbd RodAssembly: this constraint is not in the rod's set; write it into Constraints<...>");
    check_parameters<C, double>(k);
    for (auto b : beads) check_bead(C::name.view(), b);
    for (std::size_t i = 0; i < beads.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        refuse_if(beads[i] == beads[j], C::name.view(),
                  "acts on bead " + std::to_string(beads[i]) + " twice; give different beads");
    if constexpr (detail::needs_chain<typename Body::Solver>) check_chain<C>(beads);
    of<C>().beads.push_back(beads);
    of<C>().parameters.push_back(k);
  }

  // Slots that each domain needs, for SimulationOptions::capacity.
  std::vector<Capacity> capacity() const {
    std::vector<Capacity> all{{Beads::name.view(), beads()}};
    for_each_type(typename Set::List{}, [&]<class C>(std::type_identity<C>) {
      all.push_back({C::name.view(), instances<C>()});
    });
    return all;
  }

  // Writes everything into environment `env` of a store (core/state.hpp), instances ordered by colour.
  template <class Store>
  void write(Store& store, std::int64_t env, VisitOrder visit = VisitOrder::coloured) const {
    using T = typename Store::Scalar;
    auto& table = store.template table<Beads>();
    table.set_live(env, beads());
    for (std::int64_t b = 0; b < beads(); ++b) {
      auto const i = static_cast<std::size_t>(b);
      table.template set<bead::Position>(env, b, cast<T>(positions_[i]));
      table.template set<bead::Velocity>(env, b, cast<T>(velocities_[i]));
      table.template set<bead::InverseMass>(env, b, T(inverse_masses_[i]));
      table.template set<bead::Previous>(env, b, cast<T>(positions_[i]));
    }
    for_each_type(typename Set::List{},
                  [&]<class C>(std::type_identity<C>) { write_instances<C>(store, env, visit); });
  }

 private:
  template <class C> struct Held { detail::InstanceList<C> list; };
  template <class List> struct AllOf;
  template <class... Cs> struct AllOf<TypeList<Cs...>> : Held<Cs>... {};

  template <class C> auto& of() { return static_cast<Held<C>&>(all_).list; }
  template <class C> auto const& of() const { return static_cast<Held<C> const&>(all_).list; }

  static void refuse_if(bool bad, std::string_view owner, std::string const& sentence) {
    if (bad)
      throw std::invalid_argument("mpmpbd RodAssembly, " + std::string(owner) + ": " + sentence);
  }
  void check_bead(std::string_view owner, std::int64_t b) const {
    refuse_if(b < 0 || b >= beads(), owner,
              "bead " + std::to_string(b) + " does not exist; the rod has beads 0 to " +
                  std::to_string(beads() - 1));
  }
  template <class C>
  void check_chain(std::array<std::int64_t, detail::InstanceList<C>::points> const& beads) const {
    for (std::size_t i = 1; i < beads.size(); ++i)
      refuse_if(
          beads[i] != beads[i - 1] + 1, C::name.view(),
          "beads " + std::to_string(beads[i - 1]) + ", " + std::to_string(beads[i]) +
              " do not follow each other, which the direct banded solver needs; number the beads along the thread, or take Xpbd<8>");
    for (auto const& other : of<C>().beads)
      refuse_if(other[0] == beads[0], C::name.view(),
                "given twice at bead " + std::to_string(beads[0]) +
                    "; the direct banded solver takes one per bead");
  }

  template <class C, class Store>
  void write_instances(Store& store, std::int64_t env, VisitOrder visit) const {
    using T = typename Store::Scalar;
    using Its = instance<C>;
    auto const& list = of<C>();
    auto colours = colour_greedily(list.beads, beads());
    if (visit == VisitOrder::along) std::iota(colours.begin(), colours.end(), 0);
    std::vector<std::size_t> order(list.beads.size());
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
      typename Its::Index::Shape::template Value<T> index{};
      if constexpr (Its::Index::components == 1)
        index = list.beads[from][0];
      else
        for (std::size_t i = 0; i < list.beads[from].size(); ++i)
          index[static_cast<int>(i)] = list.beads[from][i];
      table.template set<typename Its::Index>(env, s, index);
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

  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<double> inverse_masses_;
  AllOf<typename Set::List> all_;
};

}  // namespace mpmpbd
