// Every constraint against the law suite that users get.
#include "catch.hpp"

#include <mpmpbd/pbd/constraints/attachment.hpp>
#include <mpmpbd/pbd/constraints/bend.hpp>
#include <mpmpbd/pbd/constraints/bend_twist.hpp>
#include <mpmpbd/pbd/constraints/distance.hpp>
#include <mpmpbd/pbd/constraints/half_space.hpp>
#include <mpmpbd/pbd/constraints/minimum_distance.hpp>
#include <mpmpbd/pbd/constraints/pin.hpp>
#include <mpmpbd/pbd/constraints/stretch_shear.hpp>
#include <mpmpbd/pbd/constraints/swage.hpp>
#include <mpmpbd/testing/constraint_laws.hpp>

using namespace mpmpbd;

namespace {
template <class C> struct Sample;
// One line per constraint: its parameters for configurations of 20 mm.
template <> struct Sample<Distance> {
  static auto k() { return Distance::Parameters<double>{13e-3, 2.4e-5}; }
};
template <> struct Sample<Bend> {
  static auto k() { return Bend::Parameters<double>{0.9, 7e3}; }
};
template <> struct Sample<Pin> {
  static auto k() { return Pin::Parameters<double>{4e-3, -7e-3, 2e-3, 2.4e-3}; }
};
template <> struct Sample<Attachment> {
  static auto k() { return Attachment::Parameters<double>{2.4e-3}; }
};
template <> struct Sample<Swage> {
  static auto k() { return Swage::Parameters<double>{6e-3, 11e-3, -3e-3, 2.4e-3}; }
};
template <> struct Sample<MinimumDistance> {
  static auto k() { return MinimumDistance::Parameters<double>{31e-3, 2.4e-5}; }
};
template <> struct Sample<HalfSpace> {
  static auto k() { return HalfSpace::Parameters<double>{0.3, -1.7, 0.8, 5e-3, 1e-4}; }
};
template <> struct Sample<StretchShear> {
  static auto k() { return StretchShear::Parameters<double>{13e-3, 2.4e-5, 3.1e-5}; }
};
template <> struct Sample<BendTwist> {
  static auto k() { return BendTwist::Parameters<double>{0.3, -0.2, 0.4, 70, 94}; }
};

template <class C, class T> void check_laws() {
  for (auto const& law : constraint_laws<C, T>(Sample<C>::k(), 20e-3)) {
    INFO(C::name.view() << ", " << 8 * sizeof(T) << " bits: " << law.text());
    CHECK(law.holds());
  }
}
}  // namespace

TEMPLATE_TEST_CASE("a constraint keeps the laws", "[constraint][laws]", Distance, Bend, Pin,
                   Attachment, Swage, MinimumDistance, HalfSpace, StretchShear, BendTwist) {
  check_laws<TestType, double>();
  check_laws<TestType, float>();
}
