// B43: tissue in float, on a device too, is the host's in double to a thousandth of the motion; and what rounding to counts
// adds where velocities are multiplied by gradients of weights.
// seconds: 1
// on a device
#include <mpmpbd/mpm/materials/fixed_corotated.hpp>
#include <mpmpbd/mpm/materials/neo_hookean.hpp>
#include <mpmpbd/mpm/materials/stable_neo_hookean.hpp>
#include <mpmpbd/mpm/transfer/tpic.hpp>

#include "catch.hpp"
#include "physics/back_end.hpp"
#include "physics/swinging_block.hpp"

using namespace test;

namespace {

// What fixed point may add to such schemes [m]. A node that one particle alone reaches, with the rim of its stencil, d cells in,
// has a weight of w = d^2 / 2 along that axis and a gradient of 2 w / d; its velocity is rounded to half a count over w, so
// that the particle's strain is off by count / d, whatever the weights along other axes are. Rims lie anywhere: the mean
// square over d from the least one, whose weight is one count, to 1 is 1 / least d. It walks at random through all substeps,
// and adds up over the block. Three standard deviations; what a block meets depends on where its rims lie.
template <class S> double noise_of_gradients(BlockCase const& c) {
  constexpr double count = quantum<float>;
  if (count == 0.0 || !std::is_same_v<typename S::Body::Form, WeightGradient>) return 0.0;
  double const least = std::sqrt(2.0 * count);
  double const strain = count * std::sqrt(swinging_steps / least);
  return 3.0 * strain * c.cells[0] * c.cell;
}

// Largest difference of the places in float and double, over the largest way.
template <class S> void check_float(double amplitude) {
  auto const fine = swung<S, double>(amplitude);
  auto const coarse = swung<S, float, BackEnd>(amplitude);
  CHECK(fine.run.status(0) == 0);
  CHECK(coarse.run.status(0) == 0);
  auto const start = fine.c.positions();
  double worst = 0, way = 0;
  for (std::int64_t p = 0; p < fine.size(); ++p) {
    auto const x = fine.template get<particle::Position>(p);
    worst = max(worst, norm(coarse.template get<particle::Position>(p) - x));
    way = max(way, norm(x - start[static_cast<std::size_t>(p)]));
  }
  CAPTURE(amplitude, worst / way, way / fine.c.cell);
  CHECK(worst < 1e-3 * way + noise_of_gradients<S>(fine.c));
}

}  // namespace

// Places are rounded to about 1e-7 of the domain, so a way of a hundredth of a cell is known to 1e-4.
TEST_CASE("float is double to a thousandth of the motion and what counts add",
          "[mpm][stability][B43]") {
  for (double const amplitude : {5.0, 0.5}) {
    check_float<Swinging<NeoHookean>>(amplitude);
    check_float<Swinging<NeoHookean, Flip, WeightGradient>>(amplitude);
    check_float<Swinging<StableNeoHookean, CubicBSpline>>(amplitude);
    check_float<Swinging<FixedCorotated, Tpic, WeightGradient>>(amplitude);
  }
}
