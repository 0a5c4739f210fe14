// The coupling of docs/tutorials/write_a_coupling.md: what is shown there is compiled and tested here.
#include "catch.hpp"
#include "shown.hpp"

#include <mpmpbd/mpm/materials/neo_hookean.hpp>

#include <mpmpbd/coupling/coupling.hpp>
#include <mpmpbd/coupling/weights.hpp>
#include <mpmpbd/scene/rod_stage.hpp>
#include <mpmpbd/testing/coupling_laws.hpp>

using namespace mpmpbd;

// What the strategy stores: it is saved, restored, reset and cloned with the rest.
namespace bead_in_gel {
struct Impulse : Field<"J_gel", "N s", Vector, Beads> {
};  // of the bead on the tissue, last substep
}  // namespace bead_in_gel

// The stage between grid and gather. `In` are the parts of the scene that it stands in.
template <class In> struct GripByGel {
  static constexpr FixedString name = "gel";
  using Kind = kind::Together;
  using Rods = typename In::Rods;
  using Laws_ = typename In::Coupling;
  using Forces = in_slot_t<Slot::before_solve, typename In::Effects>;
  using Parts = join_t<Forces, typename Rods::Leaves, typename Laws_::Leaves>;
  using Reads = union_t<Fields<node::Velocity, node::Mass>, typename Rods::Reads,
                        typename detail::ReadsOf<Forces>::type>;
  using Writes = union_t<Fields<node::Velocity, bead_in_gel::Impulse>, typename Rods::Writes,
                         typename detail::WritesOf<Forces>::type>;

  static_assert(!In::has_needle,
                "Gel: knows threads alone; take the needle out, or write Coupling<Embedded>");

  template <class Team_, class Env, class Ctx, class Grid>
  MPMPBD_HD static std::uint32_t run(Team_ const& team, Env const& env, Ctx const& context,
                                     Grid const& grid) {
    detail::apply_all_to_beads(Forces{}, team, env, context);
    std::uint32_t faults = Rods::predict(team, env, context.tick);
    faults |= Rods::template solve<typename Laws_::Strategy::Takes>(team, env, context.tick);
    faults |= Rods::finish(team, env, context.tick);
    // First every bead's impulse from one and the same grid, then all of them at once: no order.
    int const beads = static_cast<int>(env.template live<Beads>());
    team.each(beads, [&](int k) { find_impulse(env, context, grid, k, beads); });
    team.sync();
    team.one([&] {
      for (int k = 0; k < beads; ++k) apply_impulse(env, context, grid, k);
    });
    team.sync();
    return faults;
  }

 private:
  using Shape = typename In::Body::Shape;
  static constexpr int n = nodes_per_point<Shape>;

  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void find_impulse(Env const& env, Ctx const& context, Grid const& grid, int k,
                                     int beads) {
    using T = typename Ctx::Scalar;
    T weight[n];
    int node[n];
    Vec3<T> J{};
    auto const x = env.template get<bead::Position>(k);
    if (embedding_weights<Shape>(context.lattice, x, grid, weight, node) > T(0)) {
      Vec3<T> tissue{};
      T yields = T(0);  // 1/kg
      for (int a = 0; a < n; ++a) {
        if (weight[a] == T(0)) continue;
        tissue += weight[a] * grid.velocity(node[a]);
        yields += square(weight[a]) / grid.mass(node[a]);
      }
      // Implicit, so that no step is too long; `beads` of them may act on the same nodes.
      T const c = context.template of<typename Laws_::Strategy>().grip * context.tick.dt;
      T const share = c / (1 + c * (env.template get<bead::InverseMass>(k) + T(beads) * yields));
      J = share * (env.template get<bead::Velocity>(k) - tissue);
    }
    env.template set<bead_in_gel::Impulse>(k, J);
  }
  template <class Env, class Ctx, class Grid>
  MPMPBD_HD static void apply_impulse(Env const& env, Ctx const& context, Grid const& grid, int k) {
    using T = typename Ctx::Scalar;
    auto const J = env.template get<bead_in_gel::Impulse>(k);
    if (dot(J, J) == T(0)) return;
    T weight[n];
    int node[n];
    embedding_weights<Shape>(context.lattice, env.template get<bead::Position>(k), grid, weight,
                             node);
    for (int a = 0; a < n; ++a)
      if (weight[a] != T(0))
        grid.set_velocity(node[a], grid.velocity(node[a]) + weight[a] / grid.mass(node[a]) * J);
    auto const v = env.template get<bead::Velocity>(k);
    env.template set<bead::Velocity>(k, v - env.template get<bead::InverseMass>(k) * J);
  }
};

// The tissue holds every bead like a gel: a force [N] of `grip` times the slip, against it.
struct Gel {
  static constexpr FixedString name = "gel";
  using Takes = TypeList<>;  // the rod's own solver keeps its constraints
  static constexpr Conserves conserves = Conserves::momentum;
  static constexpr bool couples_needles = false;  // for the laws
  template <class T> struct Parameters {
    T grip;  // [N s/m]
  };
  static constexpr std::array<ParameterInfo, 1> parameter_info{
      {bound::not_negative("grip", "N s/m")}};
  template <class In> using Stages = TypeList<GripByGel<In>>;
};

struct Jelly : Mpm<NeoHookean> {};
struct Strand : Pbd<Constraints<Distance>> {};
struct StrandInJelly : Scene<Jelly, Strand, Coupling<Gel>> {};

TEST_CASE("gel keeps the laws of a coupling", "[coupling][example]") {
  for (auto const& law : coupling_laws<Coupling<Gel>, double>({.strategy = {2e-3}})) {
    INFO(law.text());
    CHECK(law.holds());
  }
}

TEST_CASE("the tutorial shows this coupling", "[coupling][example]") {
  CHECK(blocks_not_in(__FILE__, "tutorials/write_a_coupling.md") == std::vector<std::string>{});
}
