// A grid, a thread and a needle on the host: what an exchange needs, without a simulation around it.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <mpmpbd/coupling/workspace.hpp>
#include <mpmpbd/mpm/shape/bspline.hpp>

namespace test {

using mpmpbd::Contact;
using mpmpbd::Mat3;
using mpmpbd::Motion;
using mpmpbd::Vec3;

// The nodes as the exchange sees them.
template <class T> struct GridNodes {
  T const* m;
  Vec3<T> const* inverse;
  Vec3<T>* v;
  MPMPBD_HD T mass(int i) const { return m[i]; }
  MPMPBD_HD Vec3<T> inverse_mass(int i) const { return inverse[i]; }
  MPMPBD_HD Vec3<T> velocity(int i) const { return v[i]; }
  MPMPBD_HD void set_velocity(int i, Vec3<T> const& a) const { v[i] = a; }
};

template <class T, class Form_> struct Rig {
  using Form = Form_;
  mpmpbd::Lattice<T> lattice;
  std::vector<T> mass;
  std::vector<Vec3<T>> inverse_mass, velocity;

  std::vector<Vec3<T>> bead, bead_velocity;
  std::vector<T> bead_mass, rest_length, rest_angle, impulse;
  std::vector<char> known;
  mpmpbd::RigidBody<T> needle{};
  std::vector<mpmpbd::ContactPoint<T>> points;
  int needle_points = 0, attached_points = 0, touched_nodes = 0;
  T dt = T(0.1), previous_dt = T(0.1), rest_density = 0;
  T stretch_compliance = T(1e-3), bending_stiffness = 0;
  mpmpbd::parameters_t<typename Form::FrictionLaw, T> friction{};
  mpmpbd::parameters_t<typename Form::DragLaw, T> drag{};

  std::vector<char> memory;

  Rig(int nx, int ny, int nz, T dx) : lattice(mpmpbd::Lattice<T>::make(dx, nx, ny, nz)) {
    auto const n = static_cast<std::size_t>(lattice.count());
    mass.assign(n, T(0));
    inverse_mass.assign(n, Vec3<T>{});
    velocity.assign(n, Vec3<T>{});
  }
  int beads() const { return static_cast<int>(bead.size()); }
  int thread_points() const { return capacity().thread_points(); }

  void add_bead(Vec3<T> const& x, T m) {
    bead.push_back(x);
    bead_velocity.push_back({});
    bead_mass.push_back(m);
    known.push_back(0);
    rest_angle.push_back(0);
    impulse.push_back(0);
    rest_length.push_back(0);
    auto const n = bead.size();
    if (n > 1) rest_length[n - 2] = mpmpbd::norm(bead[n - 1] - bead[n - 2]);
  }
  // Call when beads and needle points are all there. Thread points come first, all members at first.
  void allocate(std::vector<mpmpbd::ContactPoint<T>> const& needle_pts = {},
                std::vector<mpmpbd::ContactPoint<T>> const& attached = {}) {
    points.assign(static_cast<std::size_t>(thread_points()), {});
    for (auto& p : points) p.contact = Contact::member;
    points.insert(points.end(), needle_pts.begin(), needle_pts.end());
    points.insert(points.end(), attached.begin(), attached.end());
    needle_points = static_cast<int>(needle_pts.size());
    attached_points = static_cast<int>(attached.size());
    memory.assign(mpmpbd::exchange_bytes<T, Form>(capacity()), 0);
  }
  mpmpbd::ExchangeCapacity capacity() const {
    return {beads(), needle_points, attached_points, touched_nodes,
            static_cast<int>(lattice.count())};
  }
  mpmpbd::ThreadState<T> thread() {
    return {beads(),
            bead.data(),
            bead_velocity.data(),
            bead_mass.data(),
            reinterpret_cast<bool const*>(known.data()),
            rest_length.data(),
            rest_angle.data(),
            impulse.data(),
            stretch_compliance,
            bending_stiffness};
  }
  mpmpbd::ExchangeView<T, Form> view() {
    mpmpbd::ExchangeView<T, Form> x{};
    x.lattice = lattice;
    x.rest_density = rest_density;
    x.dt = dt;
    x.previous_dt = previous_dt;
    x.thread = thread();
    x.needle = &needle;
    x.points = points.data();
    x.needle_points = needle_points;
    x.attached_points = attached_points;
    x.friction = friction;
    x.drag = drag;
    mpmpbd::use_workspace(x, capacity(), memory.data());
    return x;
  }
  GridNodes<T> nodes() { return {mass.data(), inverse_mass.data(), velocity.data()}; }

  // Tissue velocity minus body velocity at a point, where the last exchange saw it.
  Vec3<T> slip(int q) {
    constexpr int n = mpmpbd::nodes_per_point<typename Form::Shape>;
    T w[n];
    int node[n];
    auto const& p = points[static_cast<std::size_t>(q)];
    Vec3<T> u{};
    if (!(mpmpbd::embedding_weights<typename Form::Shape>(lattice, p.position, nodes(), w, node) >
          0))
      return u;
    for (int a = 0; a < n; ++a) u += w[a] * velocity[static_cast<std::size_t>(node[a])];
    if (p.segment < 0)
      return u - needle.velocity - mpmpbd::cross(needle.spin, p.position - needle.centre);
    auto const k = static_cast<std::size_t>(p.segment);
    return u - (1 - p.along) * bead_velocity[k] - p.along * bead_velocity[k + 1];
  }

  // One substep's coupling; thread points in tissue less dense than `least` are off.
  std::uint32_t couple(double least = 0.25) {
    return couple(least, [](Rig& rig, auto const& x) {
      return mpmpbd::exchange(mpmpbd::Solo{}, x, rig.nodes());
    });
  }
  template <class Exchange> std::uint32_t couple(double least, Exchange const& exchange) {
    auto x = view();
    mpmpbd::Solo const team;
    mpmpbd::place_thread_points(team, x);
    mpmpbd::embed_points(team, x, nodes());
    for (int q = 0; q < thread_points(); ++q) {
      auto& p = points[static_cast<std::size_t>(q)];
      if (p.contact == Contact::member || p.contact == Contact::off)
        p.contact = double(p.coverage) >= least ? Contact::member : Contact::off;
    }
    auto const faults = exchange(*this, x);
    previous_dt = dt;
    return faults;
  }
};

// Control: points at these places of every segment, in [0, 1], instead of at the beads. They take the slots of
// attachments, as many as segments times places; call after place_thread_points.
template <class View>
void place_on_segments(View const& x, std::vector<typename View::Scalar> const& places) {
  for (int q = 0; q < x.thread_points(); ++q) x.points[q].contact = Contact::off;
  auto* p = x.points + x.first_attached();
  for (int k = 0; k + 1 < x.thread.beads; ++k)
    for (auto const s : places) {
      mpmpbd::place_on_thread(x, *p, k, s);
      p->length = x.thread.rest_length[k] / typename View::Scalar(places.size());
      p->contact = Contact::member;
      ++p;
    }
}

// Energy that one exchange may not raise: kinetic, plus the stretch (and bending) of the thread as the
// linearised equations see it before and after.
template <class T, class Form> double kinetic_energy(Rig<T, Form> const& r) {
  double e = 0;
  for (std::size_t i = 0; i < r.mass.size(); ++i)
    for (int a = 0; a < 3; ++a)
      if (r.inverse_mass[i][a] > 0)
        e += 0.5 / double(r.inverse_mass[i][a]) * std::pow(double(r.velocity[i][a]), 2);
  for (std::size_t k = 0; k < r.bead.size(); ++k)
    if (!r.known[k])
      e += 0.5 * double(r.bead_mass[k]) *
           double(mpmpbd::dot(r.bead_velocity[k], r.bead_velocity[k]));
  if (r.needle.motion == Motion::dynamic)
    e += 0.5 * double(r.needle.mass * mpmpbd::dot(r.needle.velocity, r.needle.velocity) +
                      mpmpbd::dot(r.needle.spin, r.needle.inertia * r.needle.spin));
  return e;
}

// Its stretch and bending, before (from the shape: after place_thread_points) and after (from the solution).
template <class T, class Form>
double thread_energy(Rig<T, Form>& r, bool after,
                     std::vector<mpmpbd::Joint<T>> const& joints = {}) {
  auto x = r.view();
  double e = 0;
  for (int k = 0; k + 1 < r.beads(); ++k) {
    double const c = double(x.thread_work.links[k].compliance),
                 g = double(x.thread_work.gap_speed[k]);
    double const lambda = double(x.thread_work.trial[k + 1].link());
    if (c > 0) e += after ? 0.5 * c * lambda * lambda : 0.5 * g * g / c;
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    double angle = double(joints[k].excess);
    if (after && joints[k].stiffness > 0)
      for (std::size_t a = 0; a < 3; ++a)
        angle += double(r.dt * mpmpbd::dot(joints[k].in_plane[a], r.bead_velocity[k - 1 + a]));
    e += 0.5 * double(joints[k].stiffness) * angle * angle;
  }
  return e;
}

}  // namespace test
