// `Embedded` on scales: what the grid gains in an exchange, weighed at the nodes, so that what the coupling
// reports of its bodies can be held against it.
#pragma once

#include <vector>

#include <mpmpbd/coupling/embedded.hpp>

namespace test {

// Gains of the grid in the exchanges of the last step; moments about the origin.
namespace scales {
struct Impulse : mpmpbd::Field<"J_grid", "N s", mpmpbd::Vector, mpmpbd::Environments> {};
struct Moment : mpmpbd::Field<"L_grid", "N m s", mpmpbd::Vector, mpmpbd::Environments> {};
// Impulses times the velocities after them, with which tissue moves on; and the kinetic energy they bring.
struct Work : mpmpbd::Field<"W_grid", "J", mpmpbd::Number, mpmpbd::Environments> {};
struct Kinetic : mpmpbd::Field<"K_grid", "J", mpmpbd::Number, mpmpbd::Environments> {};
}  // namespace scales

template <class In> struct WeighedExchange : mpmpbd::ExchangeImpulses<In> {
  using Exchange = mpmpbd::ExchangeImpulses<In>;
  using Writes =
      mpmpbd::union_t<typename Exchange::Writes, mpmpbd::Fields<scales::Impulse, scales::Moment,
                                                                scales::Work, scales::Kinetic>>;

  template <class Team_, class Env, class Ctx, class Grid>
  static std::uint32_t run(Team_ const& team, Env const& env, Ctx const& context,
                           Grid const& grid) {
    using T = typename Ctx::Scalar;
    auto const& lattice = context.lattice;
    int const n = static_cast<int>(lattice.count());
    std::vector<mpmpbd::Vec3<double>> before(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i)
      before[static_cast<std::size_t>(i)] = mpmpbd::cast<double>(grid.velocity(i));

    auto const faults = Exchange::run(team, env, context, grid);

    mpmpbd::Vec3<double> impulse{}, moment{};
    double work = 0, kinetic = 0;
    for (int i = 0; i < n; ++i) {
      auto const v = mpmpbd::cast<double>(grid.velocity(i)),
                 u = before[static_cast<std::size_t>(i)];
      auto const gain = double(grid.mass(i)) * (v - u);
      int const row = i / lattice.nodes[0];
      auto const x =
          lattice.position(i % lattice.nodes[0], row % lattice.nodes[1], row / lattice.nodes[1]);
      impulse += gain;
      moment += mpmpbd::cross(mpmpbd::cast<double>(x), gain);
      work += mpmpbd::dot(gain, v);
      kinetic += 0.5 * mpmpbd::dot(gain, v + u);
    }
    bool const first = context.tick.substep == 0;
    auto add = [&]<class F>(F, auto const& gain) {
      env.template set<F>(0, first ? gain : env.template get<F>(0) + gain);
    };
    add(scales::Impulse{}, mpmpbd::cast<T>(impulse));
    add(scales::Moment{}, mpmpbd::cast<T>(moment));
    add(scales::Work{}, static_cast<T>(work));
    add(scales::Kinetic{}, static_cast<T>(kinetic));
    return faults;
  }
};

struct WeighedEmbedded : mpmpbd::Embedded {
  static constexpr mpmpbd::FixedString name = "Embedded on scales";
  template <class In>
  using Stages = mpmpbd::join_t<mpmpbd::TypeList<WeighedExchange<In>>, mpmpbd::FollowTissue<In>>;
};
// In a scene instead of Coupling<Embedded, laws...>.
template <class... Laws> struct OnScales : mpmpbd::Coupling<mpmpbd::Embedded, Laws...> {
  using Strategy = WeighedEmbedded;
};

}  // namespace test
