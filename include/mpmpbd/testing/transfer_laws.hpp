// Laws of a transfer scheme with its shape function and force form: what a body gives to the grid and
// takes back. No time stepping, so every limit is rounding, relative to the scale that the law names.
#pragma once

#include <string>
#include <vector>

#include <mpmpbd/mpm/gather.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>
#include <mpmpbd/testing/worst.hpp>

namespace mpmpbd {

// What a transfer scheme promises beyond mass and linear momentum, which all of them keep.
struct TransferClaims {
  bool rigid_motion;      // a rigid motion survives grid and back unchanged
  bool angular_momentum;  // with the affine part counted, also through the gather
};
// The claims of the schemes as they are published: affine particles keep a rigid motion, and angular
// momentum when they carry the moment; FLIP keeps what the grid does not change.
template <class Body> constexpr TransferClaims published_claims() {
  using Transfer = typename Body::Transfer;
  return {Transfer::carries_affine || Transfer::needs_previous_grid,
          Transfer::carries_affine && Transfer::needs_moment};
}

namespace testing {

// A dense grid that scatters add to and gathers read.
template <class T> struct DenseGrid {
  Lattice<T> lattice;
  std::vector<Quad<T>> sums, before;

  explicit DenseGrid(Lattice<T> const& l)
      : lattice(l), sums(static_cast<std::size_t>(l.count()), quad<T>(0, 0, 0, 0)), before(sums) {}

  struct Row {
    Quad<T>* first;
    Quad<T>* previous;
    Row operator+(std::int64_t n) const { return {first + n, previous + n}; }
    void add(int n, Quad<T> const& q) const { first[n] = first[n] + q; }
    void add_previous(int n, Quad<T> const& q) const { previous[n] = previous[n] + q; }
  };
  struct Writer {
    DenseGrid* grid;
    auto window(int const (&at)[3]) const {
      return grid->window(Row{grid->sums.data(), grid->before.data()}, at);
    }
  };
  Writer writer() { return {this}; }
  auto window(int const (&at)[3]) const { return window(sums.data(), at); }
  auto previous_window(int const (&at)[3]) const { return window(before.data(), at); }
  template <class Row> auto window(Row const& origin, int const (&at)[3]) const {
    std::int64_t const next_row = lattice.nodes[0], next_plane = next_row * lattice.nodes[1];
    return Window{origin + lattice.index(at[0], at[1], at[2]), next_row, next_plane};
  }

  template <class Function> void for_each_node(Function&& f) {
    for (int k = 0; k < lattice.nodes[2]; ++k)
      for (int j = 0; j < lattice.nodes[1]; ++j)
        for (int i = 0; i < lattice.nodes[0]; ++i)
          f(lattice.position(i, j, k), static_cast<std::size_t>(lattice.index(i, j, k)));
  }
  // Momentum becomes velocity; the mass stays in the fourth lane.
  void divide() {
    for (auto* list : {&sums, &before})
      for (auto& n : *list) {
        T const m = n[3];
        n = m > T(0) ? quad<T>(n[0] / m, n[1] / m, n[2] / m, m) : quad<T>(0, 0, 0, 0);
      }
  }
};

template <class Body, class T> class TransferProbe {
 public:
  using Shape = typename Body::Shape;
  using Transfer = typename Body::Transfer;
  using Item = Local<T, union_t<typename Scatter<Body>::Reads, typename Gather<Body>::Reads,
                                typename Gather<Body>::Writes>>;
  using K = parameters_t<Transfer, T>;

  TransferProbe(K const& k, unsigned long long seed) : k_(k), random_(seed) {}

  static constexpr bool smooth = Shape::inverse_inertia > 0.0;

  Lattice<T> lattice() const { return Lattice<T>::make(T(3.7e-3), 15, 13, 14); }

  // A particle anywhere, on a node, in the middle of a cell or close to one of them on each axis.
  // `on_nodes` = false: anywhere only. On a node a linear shape has a slope at nodes of
  // weight 0, which have neither the mass that a push needs nor the velocity that a gradient needs.
  Item particle(bool on_nodes = true) {
    Item p{};
    auto const l = lattice();
    for (int a = 0; a < 3; ++a) {
      double cells =
          random_.uniform(lowest_cell<Shape, double>(), highest_cell<Shape, double>(l.nodes[a]));
      int const kind = static_cast<int>(random_.uniform(0.0, 4.0));
      double const shift = random_.uniform(-1.0, 1.0) * (kind == 1 ? 1e-7 : kind == 2 ? 1e-3 : 0.0);
      if (kind > 0 && on_nodes)
        cells = clamp(mpmpbd::floor(2.0 * cells) / 2.0 + shift, lowest_cell<Shape, double>(),
                      highest_cell<Shape, double>(l.nodes[a]));
      p[particle::Position{}][a] = T(cells) * l.dx;
    }
    p[particle::Mass{}] = T(random_.log_uniform(2e-6, 2e-4));
    p[particle::Volume{}] = p[particle::Mass{}] / T(1050);
    p[particle::Velocity{}] = cast<T>(random_.template matrix<3>(-2.0, 2.0));
    p[particle::Deformation{}] = cast<T>(random_.deformation(0.7, 1.4));
    auto const A = random_.template matrix<3, 3>(-1e4, 1e4);
    p[particle::Stress{}] = cast<T>(A + transpose(A));
    if constexpr (Transfer::carries_affine)
      p[particle::Affine{}] = cast<T>(random_.template matrix<3, 3>(-100.0, 100.0));
    return p;
  }

  // A1.1: nodes carry a + A x, before forces b + B x.
  void affine_field(int count) {
    for (int n = 0; n < count; ++n) {
      DenseGrid<T> grid(lattice());
      auto const a = random_.template matrix<3>(-2.0, 2.0),
                 b = random_.template matrix<3>(-2.0, 2.0);
      auto const A = random_.template matrix<3, 3>(-100.0, 100.0);
      auto const B = random_.template matrix<3, 3>(-100.0, 100.0);
      double fastest = 0.0;
      grid.for_each_node([&](Vec3<T> const& x, std::size_t at) {
        auto const v = a + A * cast<double>(x);
        fastest = max(fastest, norm(v));
        grid.sums[at] = quad(cast<T>(v), T(0));
        grid.before[at] = quad(cast<T>(b + B * cast<double>(x)), T(0));
      });
      Item p = particle();
      Item const old = p;
      auto const x = cast<double>(p[particle::Position{}]);
      auto const exact = a + A * x;
      double const per_cell = fastest / double(grid.lattice.dx);  // scale of gradients: |v| / dx
      T const dt = T(1e-4);
      gather(p, grid, dt);
      Vec3<double> moved = x + double(dt) * exact;
      for (int c = 0; c < 3; ++c)  // held at the border of the domain
        moved[c] =
            clamp(moved[c], lowest_cell<Shape, double>() * double(grid.lattice.dx),
                  highest_cell<Shape, double>(grid.lattice.nodes[c]) * double(grid.lattice.dx));
      if constexpr (requires { k_.blend; }) {
        auto const kept = cast<double>(old[particle::Velocity{}]) - (b + B * x);
        carried.include(
            norm(cast<double>(p[particle::Velocity{}]) - (exact + double(k_.blend) * kept)) /
            (fastest + norm(kept)));
      } else if constexpr (!Transfer::needs_previous_grid) {
        carried.include(norm(cast<double>(p[particle::Velocity{}]) - exact) / fastest);
      }
      gradient.include(norm(cast<double>(p[particle::Gradient{}]) - A) / per_cell);
      if constexpr (Transfer::carries_affine)
        gradient.include(norm(cast<double>(p[particle::Affine{}]) - A) / per_cell);
      auto const F = cast<double>(old[particle::Deformation{}]);
      auto const turned = F + double(dt) * (A * F);
      deformation.include(norm(cast<double>(p[particle::Deformation{}]) - turned) /
                          (norm(F) * (1.0 + double(dt) * per_cell)));
      position.include(norm(cast<double>(p[particle::Position{}]) - moved) / norm(moved));
    }
  }

  // A1.2: forces of one particle, read from the momentum that they leave.
  void virial(int count) {
    for (int n = 0; n < count; ++n) {
      DenseGrid<T> grid(lattice());
      Item p = particle();
      p[particle::Velocity{}] = {};
      if constexpr (Transfer::carries_affine) p[particle::Affine{}] = {};
      T const dt = T(1e-4);
      scatter(p, grid, dt);
      Vec3<double> total{}, torque{};
      Mat3<double> moment{};
      auto const xp = cast<double>(p[particle::Position{}]);
      grid.for_each_node([&](Vec3<T> const& xi, std::size_t at) {
        auto const f = 1.0 / double(dt) * cast<double>(vector_part(grid.sums[at]));
        auto const d = cast<double>(xi) - xp;
        total += f;
        torque += cross(d, f);
        moment += outer(f, d);
      });
      auto const expected = -double(p[particle::Volume{}]) * cast<double>(p[particle::Stress{}]);
      double const scale = norm(expected);
      force_sum.include(norm(total) * double(grid.lattice.dx) / scale);
      force_torque.include(norm(torque) / scale);
      force_moment.include(norm(moment - expected) / scale);
    }
  }

  // A1.4: totals of a cloud of stressed particles, on the grid and taken back.
  void totals(int particles) {
    DenseGrid<T> grid(lattice());
    std::vector<Item> cloud;
    Totals before;
    for (int n = 0; n < particles; ++n) {
      cloud.push_back(particle(smooth));
      before.include(cloud.back(), grid.lattice);
      scatter(cloud.back(), grid, T(1e-4));
    }
    Totals const on_grid = of_nodes(grid);
    mass.include(mpmpbd::abs(on_grid.mass - before.mass) / before.mass);
    momentum.include(norm(on_grid.momentum - before.momentum) / before.momentum_scale);
    angular.include(norm(on_grid.angular - before.angular) / before.angular_scale);

    grid.divide();
    Totals after;
    for (auto p : cloud) {
      auto const x = p[particle::Position{}];
      // dt = 0: the velocities of this grid with the positions that weigh them.
      gather(p, grid, T(0));
      p[particle::Position{}] = x;
      after.include(p, grid.lattice);
    }
    taken_momentum.include(norm(after.momentum - before.momentum) / before.momentum_scale);
    taken_angular.include(norm(after.angular - before.angular) / before.angular_scale);
  }

  // A1.5: a motion through grid and back; errors relative to the fastest particle.
  void round_trip(int particles) {
    for (bool const rotates : {false, true}) {
      DenseGrid<T> grid(lattice());
      auto const v0 = random_.template matrix<3>(-2.0, 2.0);
      auto const w = random_.template matrix<3>(-100.0, 100.0);
      auto const W = rotates ? skew(w) : Mat3<double>{};
      std::vector<Item> cloud;
      double fastest = 0.0;
      for (int n = 0; n < particles; ++n) {
        Item p = particle(smooth);
        p[particle::Stress{}] = {};
        auto const v = v0 + W * cast<double>(p[particle::Position{}]);
        p[particle::Velocity{}] = cast<T>(v);
        if constexpr (Transfer::carries_affine) p[particle::Affine{}] = cast<T>(W);
        fastest = max(fastest, norm(v));
        cloud.push_back(p);
        scatter(p, grid, T(1e-4));
      }
      grid.divide();
      for (auto p : cloud) {
        auto const old = p;
        gather(p, grid, T(0));
        double error = norm(cast<double>(p[particle::Velocity{}] - old[particle::Velocity{}]));
        if constexpr (Transfer::carries_affine)
          error =
              max(error, double(grid.lattice.dx) * norm(cast<double>(p[particle::Affine{}]) - W));
        (rotates ? rigid : uniform).include(error / fastest);
      }
    }
  }

  Worst gradient, carried, deformation, position;
  Worst force_sum, force_torque, force_moment;
  Worst mass, momentum, angular, taken_momentum, taken_angular;
  Worst uniform, rigid;

 private:
  // One copy of each kernel for all laws: they are inlined whole, and compile slowly.
  [[gnu::noinline]] static void scatter(Item const& p, DenseGrid<T>& grid, T dt) {
    Scatter<Body>::run(p, grid.writer(), grid.lattice, dt);
  }
  [[gnu::noinline]] void gather(Item& p, DenseGrid<T> const& grid, T dt) const {
    Gather<Body>::run(p, grid, k_, grid.lattice, dt);
  }

  // Mass, momentum and angular momentum about the origin, with the sums of magnitudes.
  struct Totals {
    double mass = 0.0, momentum_scale = 0.0, angular_scale = 0.0;
    Vec3<double> momentum{}, angular{};

    void include(Item const& p, Lattice<T> const& lattice) {
      double const m = double(p[particle::Mass{}]);
      auto const x = cast<double>(p[particle::Position{}]);
      auto const v = cast<double>(p[particle::Velocity{}]);
      add(m, x, v);
      if constexpr (Transfer::carries_affine) {
        // m eps : (C D), D = sum w d d^T: diagonal, per axis.
        auto const CD = cast<double>(p[particle::Affine{}]) * inertia(p, lattice);
        Vec3<double> const spin{{CD(2, 1) - CD(1, 2), CD(0, 2) - CD(2, 0), CD(1, 0) - CD(0, 1)}};
        angular += m * spin;
        angular_scale += m * norm(CD);
      }
    }
    void add(double m, Vec3<double> const& x, Vec3<double> const& v) {
      mass += m;
      momentum += m * v;
      momentum_scale += m * norm(v);
      angular += m * cross(x, v);
      angular_scale += m * norm(x) * norm(v);
    }
  };

  static Mat3<double> inertia(Item const& p, Lattice<T> const& lattice) {
    auto const s = Stencil<T, Shape>::at(lattice, p[particle::Position{}]);
    Mat3<double> D{};
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < Shape::width; ++i)
        D(a, a) +=
            Shape::weight(i, double(s.f[a])) * square((i - double(s.f[a])) * double(lattice.dx));
    return D;
  }

  static Totals of_nodes(DenseGrid<T>& grid) {
    Totals sum;
    grid.for_each_node([&](Vec3<T> const& x, std::size_t at) {
      auto const mv = cast<double>(vector_part(grid.sums[at]));
      sum.mass += double(grid.sums[at][3]);
      sum.momentum += mv;
      sum.angular += cross(cast<double>(x), mv);
    });
    return sum;
  }

  K k_;
  Samples random_;
};

}  // namespace testing

// All laws of a body's transfer in precision T: A1.1 affine fields, A1.2 virial, A1.4 totals, A1.5 round
// trip. `k`: parameters of the transfer; FLIP keeps rigid motion with blend = 1.
template <class Body, class T>
Laws transfer_laws(parameters_t<typename Body::Transfer, T> const& k = {},
                   TransferClaims claims = published_claims<Body>(), unsigned long long seed = 7) {
  testing::TransferProbe<Body, T> probe(k, seed);
  probe.affine_field(400);
  probe.virial(400);
  probe.totals(2000);
  probe.round_trip(2000);

  Laws laws;
  auto const limit = testing::rounding_limit<T>;
  auto const add = [&](char const* name, testing::Worst const& worst) {
    laws.push_back({name, worst.value(), limit});
  };
  add("affine field: gradient = A, relative to the fastest node over dx", probe.gradient);
  add("affine field: velocity of the particle, relative to the fastest node", probe.carried);
  add("affine field: F <- (I + dt A) F, relative", probe.deformation);
  add("affine field: x <- x + dt v, relative", probe.position);
  add("virial: sum f d^T = -V0 tau, relative", probe.force_moment);
  add("virial: sum f = 0, times dx / |V0 tau|", probe.force_sum);
  add("virial: sum d x f = 0, relative to |V0 tau|", probe.force_torque);
  add("totals: mass, relative", probe.mass);
  add("totals: momentum, relative to sum m |v|", probe.momentum);
  add("totals: angular momentum, relative to sum m |x| |v|", probe.angular);
  add("totals: momentum taken back, relative to sum m |v|", probe.taken_momentum);
  if (claims.angular_momentum)
    add("totals: angular momentum taken back, relative to sum m |x| |v|", probe.taken_angular);
  add("round trip: uniform motion, relative to the speed", probe.uniform);
  if (claims.rigid_motion)
    add("round trip: rigid motion, relative to the fastest particle", probe.rigid);
  return laws;
}

}  // namespace mpmpbd
