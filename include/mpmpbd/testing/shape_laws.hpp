// Laws of a shape function: what its weights have to sum to, whatever the position and the cell size.
//
// Weights are computed in the precision under test and summed in double, so that an error is the
// weights' own. Limits are relative: rounding, not accuracy.
#pragma once

#include <cmath>
#include <limits>
#include <string>

#include <mpmpbd/mpm/lattice.hpp>
#include <mpmpbd/testing/law.hpp>
#include <mpmpbd/testing/samples.hpp>
#include <mpmpbd/testing/worst.hpp>

namespace mpmpbd {

namespace testing {

// Positions [cells] at which a shape function is asked: anywhere, on nodes, in the middle between two,
// and the next number below and above those.
template <class T> class Positions {
 public:
  Positions(double low, double high, unsigned long long seed)
      : low_(low), high_(high), random_(seed) {}
  T next() {
    int const kind = static_cast<int>(random_.uniform(0.0, 8.0));
    if (kind < 3) return static_cast<T>(random_.uniform(low_, high_));
    double const halves = std::floor(2.0 * random_.uniform(low_ + 0.5, high_ - 0.5)) / 2.0;
    T const exact = static_cast<T>(halves < low_ ? halves + 0.5 : halves);
    if (kind < 5) return exact;
    T const end = kind == 5 ? T(1e9) : T(-1e9);
    return std::nextafter(exact, end);
  }

 private:
  double low_, high_;
  Samples random_;
};

// Sums over one stencil, in double.
struct StencilSums {
  double weight = 0.0;
  Vec3<double> gradient{};         // sum grad w               [1/cell]
  Vec3<double> offset{};           // sum w d                  [cells]
  Mat3<double> inertia{};          // sum w d d^T              [cells^2]
  Mat3<double> gradient_moment{};  // sum grad w d^T           [1]
  double least = 1.0;              // smallest weight
};

template <class Shape, class T> StencilSums stencil_sums(Stencil<T, Shape> const& s) {
  struct {
    double weight[Shape::width], slope[Shape::width];
  } w[3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < Shape::width; ++i) {
      w[a].weight[i] = double(Shape::weight(i, s.f[a]));
      w[a].slope[i] = double(Shape::slope(i, s.f[a]));
    }
  StencilSums sums;
  for (int k = 0; k < Shape::width; ++k)
    for (int j = 0; j < Shape::width; ++j)
      for (int i = 0; i < Shape::width; ++i) {
        double const x = w[0].weight[i], y = w[1].weight[j], z = w[2].weight[k];
        double const dx = w[0].slope[i], dy = w[1].slope[j], dz = w[2].slope[k];
        Vec3<double> const d{{i - double(s.f[0]), j - double(s.f[1]), k - double(s.f[2])}};
        Vec3<double> const g{{dx * y * z, x * dy * z, x * y * dz}};
        double const weight = x * y * z;
        sums.weight += weight;
        sums.gradient += g;
        sums.offset += weight * d;
        sums.inertia += weight * outer(d, d);
        sums.gradient_moment += outer(g, d);
        sums.least = min(sums.least, min(x, min(y, z)));
      }
  return sums;
}

// What the laws measure on one lattice.
template <class Shape, class T> struct ShapeErrors {
  Worst unity, linear, gradient_sum, gradient_moment, inertia, coupling, negative, reach;

  void measure(T dx, int count, unsigned long long seed) {
    int const nodes = 24;
    auto const lattice = Lattice<T>::make(dx, nodes, nodes, nodes);
    Positions<T> at(lowest_cell<Shape, double>(), highest_cell<Shape, double>(nodes), seed);
    for (int n = 0; n < count; ++n) {
      Vec3<T> x;
      for (int a = 0; a < 3; ++a) x[a] = at.next() * dx;
      auto const s = Stencil<T, Shape>::at(lattice, x);
      auto const sums = stencil_sums<Shape>(s);
      unity.include(std::abs(sums.weight - 1.0));
      gradient_sum.include(norm(sums.gradient));
      gradient_moment.include(norm(sums.gradient_moment - Mat3<double>::identity()));
      for (int a = 0; a < 3; ++a) {
        double const sum = (s.base[a] + double(s.f[a]) + sums.offset[a]) * double(dx);
        linear.include(std::abs(sum - double(x[a])) / double(x[a]));
        for (int b = 0; b < 3; ++b) {
          if (a != b) coupling.include(std::abs(sums.inertia(a, b)));
          if (a == b && Shape::inverse_inertia > 0.0)
            inertia.include(std::abs(Shape::inverse_inertia * sums.inertia(a, a) - 1.0));
        }
      }
      negative.include(sums.least < 0.0 ? -sums.least : 0.0);
      reach.include(s.inside(lattice) ? 0.0 : 1.0);
    }
  }
};

// Slope against the central difference of the weight, which is continuous across cells.
template <class Shape> double slope_error(int count) {
  Worst worst;
  double const h = 1e-5;
  for (int n = 0; n < count; ++n) {
    double const f = Shape::offset + h + (1.0 - 2.0 * h) * (n + 0.5) / count;
    for (int i = 0; i < Shape::width; ++i)
      worst.include(std::abs(Shape::slope(i, f) -
                             (Shape::weight(i, f + h) - Shape::weight(i, f - h)) / (2.0 * h)));
  }
  return worst.value();
}

// Moments are inverse inertia times weight times offset; without constant inertia they are slopes.
// Their sum with the offset is 1 in both cases.
template <class Shape> double moment_error(int count) {
  Worst worst;
  for (int n = 0; n < count; ++n) {
    double const f = Shape::offset + (n + 0.5) / count;
    double sum = 0.0;
    for (int i = 0; i < Shape::width; ++i) sum += Shape::moment(i, f) * (i - f);
    worst.include(std::abs(sum - 1.0));
  }
  return worst.value();
}

template <class Shape> double mirror_error(int count) {
  Worst worst;
  for (int n = 0; n < count; ++n) {
    double const f = Shape::offset + (n + 0.5) / count;
    for (int i = 0; i < Shape::width; ++i) {
      int const m = Shape::width - 1 - i;
      double const g = Shape::width - 1 - f;
      worst.include(std::abs(Shape::weight(i, f) - Shape::weight(m, g)));
      worst.include(std::abs(Shape::slope(i, f) + Shape::slope(m, g)));
    }
  }
  return worst.value();
}

}  // namespace testing

// All laws of a shape function in precision T. `count` positions on each of two lattices: 3.7 mm cells,
// and 2^-8 m, where positions in cells are exact.
template <class Shape, class T>
Laws shape_laws(int count = 100000, unsigned long long seed = 20241) {
  testing::ShapeErrors<Shape, T> e;
  e.measure(T(3.7e-3), count, seed);
  e.measure(T(0x1p-8), count, seed + 1);

  Laws laws;
  auto const add = [&laws](char const* name, double error, double allowed) {
    laws.push_back(
        {std::string(Shape::name.view()) + (sizeof(T) == 8 ? ", double: " : ", float: ") + name,
         error, allowed});
  };
  double const limit = testing::rounding_limit<T>;
  add("sum w = 1", e.unity.value(), limit);
  add("sum w x_i = x, relative to x", e.linear.value(), limit);
  add("sum grad w = 0, times dx", e.gradient_sum.value(), limit);
  add("sum grad w d^T = I", e.gradient_moment.value(), limit);
  if (Shape::inverse_inertia > 0.0) add("sum w d d^T = D, relative to D", e.inertia.value(), limit);
  add("sum w d d^T is diagonal, times 1/dx^2", e.coupling.value(), limit);
  add("w >= 0", e.negative.value(), 0.0);
  add("every node of the stencil exists", e.reach.value(), 0.0);
  add("slope = difference quotient of the weight, times dx", testing::slope_error<Shape>(4001),
      1e-7);
  add("sum of moments times offset = 1", testing::moment_error<Shape>(4001), 1e-12);
  add("mirror image", testing::mirror_error<Shape>(4001), 1e-12);
  return laws;
}

// Patch test of a stretched lattice: particles `spacing` cells apart along an axis, each with unit stress
// and as much volume; the largest force that an interior node is left with, whatever its place between
// the particles, over stress times face area. Exact would be 0. `uses_moment`: MLS forces.
template <class Shape>
double stretched_lattice_residual(double spacing, bool uses_moment, int phases = 4000) {
  double worst = 0.0;
  for (int phase = 0; phase < phases; ++phase) {
    double force = 0.0;
    int const node = 8;
    for (int p = 0; p * spacing < 2.0 * node; ++p) {
      double const x = (p + double(phase) / phases) * spacing;
      double const first = mpmpbd::floor(x - Shape::offset);
      int const i = node - static_cast<int>(first);
      if (i < 0 || i >= Shape::width) continue;
      force += spacing * (uses_moment ? Shape::moment(i, x - first) : Shape::slope(i, x - first));
    }
    worst = max(worst, mpmpbd::abs(force));
  }
  return worst;
}

}  // namespace mpmpbd
