// A4.4: stick stiffness of a rigid shaft that is pulled along itself out of a cylinder of tissue with a fixed
// mantle: k = 2 pi mu L / ln(b/a). A line on a grid has no radius a of its own; it acts as one of radius
// a = kappa dx (Peaceman's well), so 1/k changes by ln(2) / (2 pi mu L) when cells are halved. A measured 1/k becomes
// that of a shaft of radius a when ln(kappa dx / a) / (2 pi mu L) is added to it (docs/concepts/coupling.md).
// seconds: 25
// on a device
#include "catch.hpp"

#include "physics/tissue_block.hpp"
#include "physics/units.hpp"

namespace {

using namespace test;

// A disc of tissue, two cells thick, between free faces. Nodes move along z only, as in the exact solution.
// The faces are felt by the points beside them alone: with four cells of thickness kappa is 3 % larger.
struct Shaft {
  using Form =
      mpmpbd::EmbeddedForm<mpmpbd::QuadraticBSpline, mpmpbd::NoFriction, mpmpbd::NoDrag, false>;
  static constexpr int thickness = 2, below = 3;  // in cells
  Units unit;
  int radius, across;
  Rig<double, Form> rig;
  Tissue<double> tissue;
  double time = 0;

  // The mantle's radius in cells, and where between the nodes the shaft stands.
  Shaft(int radius_, double off_x, double off_y)
      : radius(radius_),
        across(2 * radius_ + 9),
        rig(across, across, thickness + 2 * below, unit.length) {
    double const cell = unit.length, x = cell * (radius + 4 + off_x),
                 y = cell * (radius + 4 + off_y);
    auto const from_shaft = [=](double px, double py) { return std::hypot(px - x, py - y) / cell; };
    tissue.measure_in(unit, rig, 0.25, 1);
    tissue.fill(cell * mpmpbd::vec(1.0, 1.0, double(below)),
                cell * mpmpbd::vec(across - 1.0, across - 1.0, double(below + thickness)), 0,
                [&](Vec3<double> const& p) { return from_shaft(p[0], p[1]) < radius + 1.5; });
    tissue.fixed.assign(rig.mass.size(), 0);
    for (std::size_t i = 0; i < tissue.fixed.size(); ++i) {
      auto const n = std::size_t(across);
      tissue.fixed[i] = from_shaft(cell * double(i % n), cell * double(i / n % n)) >= radius;
    }
    std::vector<mpmpbd::ContactPoint<double>> points(2 * thickness);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k].position = mpmpbd::vec(x, y, cell * (below + 0.25 + 0.5 * double(k)));
      points[k].axis = mpmpbd::vec(0.0, 0.0, 1.0);
      points[k].length = 0.5 * cell;
      points[k].segment = -1;
      points[k].contact = Contact::tied;
    }
    rig.allocate(points);
    rig.needle.motion = Motion::kinematic;
  }
  // Pull of the tissue on the shaft, along z.
  double step(double speed) {
    rig.needle.velocity[2] = speed;
    tissue.scatter(rig);
    for (std::size_t i = 0; i < rig.mass.size(); ++i)
      for (int a = 0; a < 2; ++a) rig.inverse_mass[i][a] = rig.velocity[i][a] = 0;
    REQUIRE(couple_on_back_end(rig) == 0u);
    tissue.gather(rig);
    double sum = 0;
    for (auto& p : rig.points) {
      sum += p.impulse[2];
      p.position[2] += rig.dt * speed;
    }
    time += rig.dt / unit.time();
    return sum / rig.dt;
  }
};

struct Compliance {
  double value;     // 2 pi mu L / k: ln(b/a)
  double unsteady;  // relative change of the force while the tissue comes to rest
};

// Shear waves cross the disc in t = b. It is pulled for four such times and comes to rest in another ten, the
// last of them without damping.
Compliance pull(int radius, double off_x, double off_y) {
  Shaft s(radius, off_x, off_y);
  double const way = 0.05 * s.unit.length, pulling = 4 * radius, still = 13 * radius,
               end = 14 * radius;
  double early = 0, force = 0;
  int n = 0;
  while (s.time < end) {
    s.tissue.damping = s.time < still ? 3.0 / (radius * s.unit.time()) : 0;
    double const f = s.step(s.time < pulling ? way / (pulling * s.unit.time()) : 0);
    if (s.time < 0.8 * still) early = f;
    if (s.time > still + s.radius / 2.0) force += f, ++n;
  }
  force /= n;
  double const length = Shaft::thickness * s.unit.length;
  return {2 * mpmpbd::pi<double> * s.unit.modulus * length * way / force,
          std::abs(early / force - 1)};
}

// b / a of a needle of 0.5 mm in a mantle of 40 mm, in cells of 2 and 1 mm.
constexpr double shaft_ratio = 80, mean_kappa = 0.36;

// 2 pi mu L / k of that shaft, from what was measured with the mantle so many cells away.
double corrected(Compliance const& measured, double mantle) {
  return measured.value + std::log(mean_kappa * shaft_ratio / mantle);
}

}  // namespace

TEST_CASE("a shaft sticks in tissue as one of a fraction of a cell's radius",
          "[coupling][stiffness]") {
  struct Place {
    double x, y;
  };
  for (Place const at : {Place{0, 0}, Place{0.5, 0.5}, Place{0.25, 0.1}}) {
    Compliance const coarse = pull(10, at.x, at.y), fine = pull(20, at.x, at.y);
    double const slope = (fine.value - coarse.value) / std::log(2.0);
    double const kappa = 20 * std::exp(-fine.value), kappa_coarse = 10 * std::exp(-coarse.value);
    CAPTURE(at.x, at.y, coarse.value, fine.value, slope, kappa, kappa_coarse, coarse.unsteady,
            fine.unsteady);
    CHECK(coarse.unsteady < 1e-3);
    CHECK(fine.unsteady < 1e-3);
    CHECK(std::abs(slope - 1) < 0.06);
    CHECK(kappa > 0.25);
    CHECK(kappa < 0.5);
    double const thin = std::log(shaft_ratio);
    CHECK(coarse.value <
          0.9 * thin);  // as measured it is not: kappa dx is 2.2 to 3.6 times a there
    CHECK(std::abs(corrected(coarse, 10) / thin - 1) < 0.1);
    CHECK(std::abs(corrected(fine, 20) / thin - 1) < 0.1);
  }
}
