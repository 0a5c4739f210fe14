// How the host runs the stages of a substep, serially or with threads, with the same bits.
#pragma once

#include <cstddef>

#include <mpmpbd/backend/grid.hpp>
#include <mpmpbd/backend/serial.hpp>
#include <mpmpbd/coupling/team.hpp>
#include <mpmpbd/mpm/node_shares.hpp>
#include <mpmpbd/pbd/access.hpp>
#include <mpmpbd/scene/scene.hpp>
#include <mpmpbd/scene/step_bounds.hpp>

namespace mpmpbd {

// Scratch of one environment's substep: nothing in here is state.
template <class T, class NodeFields> struct Workspace {
  std::vector<Quad<T>> nodes;  // velocity and mass, after the node stage
  struct Previous {
    std::vector<Quad<T>> velocities;
  };
  struct Nothing {};
  [[no_unique_address]] std::conditional_t<contains<NodeFields, node::PreviousVelocity>, Previous,
                                           Nothing>
      previous;
  std::vector<Tile<T>> tiles;
  std::vector<std::uint32_t> faults;  // per chunk
  std::vector<StepBounds<T>> bounds;  // per chunk
  std::uint32_t faults_together = 0;  // of stages that run over the whole environment
  std::vector<double> scratch;        // of the coupling

  void reserve_scratch(std::size_t bytes) {
    std::size_t const n = (bytes + sizeof(double) - 1) / sizeof(double);
    if (scratch.size() < n) scratch.resize(n);
  }

  void prepare(Lattice<T> const& lattice, std::int64_t chunks) {
    auto const n = static_cast<std::size_t>(lattice.count());
    nodes.resize(n);
    if constexpr (contains<NodeFields, node::PreviousVelocity>) previous.velocities.resize(n);
    tiles.resize(static_cast<std::size_t>(chunks));
    faults.assign(static_cast<std::size_t>(chunks), 0);
  }
};

// Runs stages for one environment. `Lanes` spreads pieces of work over threads.
template <class Scene, class T, class Lanes> class HostEnvironment {
 public:
  using Ctx = Context<T, typename Scene::Policies>;
  using Work = Workspace<T, typename Scene::NodeFields>;
  using Store = State<T, typename Scene::StateFields>;

  HostEnvironment(Store& state, std::int64_t env, Ctx const& context, Work& work,
                  Lanes const& lanes)
      : state_(state), env_(env), context_(context), work_(work), lanes_(lanes) {
    if constexpr (Scene::has_body) live_ = state.template table<Particles>().live(env);
    work_.prepare(context.lattice, chunks());
  }

  // One substep: every stage of the scene's pipeline, in its order. Returns the faults met.
  std::uint32_t substep(Tick<T> const& tick) {
    context_.tick = tick;
    for (auto& f : work_.faults) f = 0;
    work_.faults_together = 0;
    for_each_type(typename Scene::Substep::Stages{}, [&]<class Stage>(std::type_identity<Stage>) {
      run<Stage>(typename Stage::Kind{});
    });
    std::uint32_t faults = work_.faults_together | lost_bodies();
    for (auto f : work_.faults) faults |= f;
    return faults;
  }

  std::uint32_t lost_bodies() const { return mpmpbd::lost_bodies(Solo{}, access()); }

  // Holds particles that were set from outside at the border of the domain.
  std::uint32_t hold_particles() {
    bool held = false;
    if constexpr (Scene::has_body) {
      auto const view = state_.template view<Particles>();
      for (int a = 0; a < 3; ++a) {
        auto const room =
            Room<T>::template on_axis<typename Scene::Body::Shape>(context_.lattice, a);
        T* const x = view.template plane<particle::Position>(a) + env_ * view.capacity;
        for (std::int64_t slot = 0; slot < live_; ++slot) held = room.hold(x[slot]) || held;
      }
    }
    return held ? static_cast<std::uint32_t>(Fault::escape) : 0;
  }

  // The longest recommended substep in the present state, and the faults of that state. Nothing bounds that of a thread alone.
  StepLimit<T> limit([[maybe_unused]] std::uint32_t& faults) {
    if constexpr (Scene::has_body)
      return step_limit<typename Scene::Body>(bounds(faults), context_.lattice.dx);
    else
      return {};
  }

 private:
  static constexpr bool needs_previous =
      contains<typename Scene::NodeFields, node::PreviousVelocity>;

  auto access() const { return access_environment(state_, env_, typename Store::Domains{}); }

  StepBounds<T> bounds(std::uint32_t& faults) {
    using Bounds = ParticleBounds<Scene>;
    auto& of_chunk = work_.bounds;
    of_chunk.assign(static_cast<std::size_t>(chunks()), {});
    auto const view = state_.template view<Particles>();
    auto const shares = share_nodes();
    lanes_.for_each(chunks(), [&](std::int64_t c, int) {
      auto const chunk = static_cast<std::size_t>(c);
      for_chunk(c, [&](std::int64_t index) {
        Local<T, typename Bounds::Used> p;
        p.load(view, index, typename Bounds::Reads{});
        work_.faults[chunk] |= Bounds::include(p, context_, shares, of_chunk[chunk]);
      });
    });
    StepBounds<T> all;
    for (auto const& b : of_chunk) all.include(b);
    for (auto f : work_.faults) faults |= f;
    all.speed2 = max(all.speed2, square(needle_speed<Scene>(access(), context_)));
    return all;
  }

  // How the particles share the nodes, where their limit hangs on that. One after the other: the sums have an order.
  auto share_nodes() {
    using Body = typename Scene::Body;
    if constexpr (has_bounded_stiffness<Body>) {
      return SharesDoNotMatter{};
    } else {
      using Shares = NodeShares<typename Body::Shape, T>;
      Shares shares(context_.lattice, work_.nodes);
      auto const view = state_.template view<Particles>();
      auto const each = [&](auto const& f) {
        for (std::int64_t c = 0; c < chunks(); ++c)
          for_chunk(c, [&](std::int64_t index) {
            Local<T, typename Shares::Reads> p;
            p.load(view, index, typename Shares::Reads{});
            f(p);
          });
      };
      each([&](auto const& p) { shares.add(p); });
      each([&](auto const& p) { shares.refine(p); });
      return shares;
    }
  }

  std::int64_t chunks() const { return (live_ + chunk_size - 1) / chunk_size; }

  template <class Function> void for_chunk(std::int64_t c, Function&& f) const {
    std::int64_t const first = env_ * state_.template table<Particles>().capacity();
    std::int64_t const end = (c + 1) * chunk_size < live_ ? (c + 1) * chunk_size : live_;
    for (std::int64_t slot = c * chunk_size; slot < end; ++slot) f(first + slot);
  }

  // Loads every particle of a chunk, lets the stage change it, stores it: in packs where the stage's
  // policies and the machine can.
  template <class Stage, class Grid>
  std::uint32_t each_particle(std::int64_t c, Grid const& grid) const {
    auto const view = state_.template view<Particles>();
    std::int64_t const first = env_ * view.capacity;
    std::int64_t const end = first + min((c + 1) * chunk_size, live_);
    std::int64_t index = first + c * chunk_size;
    std::uint32_t faults = 0;
#if defined(MPMPBD_HAS_PACKS)
    if constexpr (std::is_same_v<T, float> && Stage::branch_free)
      if (packs_)
        index = packs<Stage>(PackView<std::remove_const_t<decltype(view)>>{view}, index, end,
                             InPairs<Grid>{grid}, context_, faults);
#endif
    for (; index < end; ++index) faults |= one_item<Stage, T>(view, index, grid, context_);
    return faults;
  }
#if defined(MPMPBD_HAS_PACKS)
  // Whole packs from index on; returns where the rest begins.
  template <class Stage, class View_, class Grid>
  MPMPBD_WIDE_KERNEL static std::int64_t packs(View_ const& view, std::int64_t index,
                                               std::int64_t end, Grid const& grid,
                                               Ctx const& context, std::uint32_t& faults) {
    std::uint32_t met = 0;
    for (; index + lanes<Pack<T>> <= end; index += lanes<Pack<T>>)
      met |= one_item<Stage, Pack<T>>(view, index, grid, context);
    faults |= met;
    return index;
  }
#endif
  template <class Stage, class Scalar, class View_, class Grid>
  MPMPBD_INLINE static std::uint32_t one_item(View_ const& view, std::int64_t index,
                                              Grid const& grid, Ctx const& context) {
    using Reads = on_t<typename Stage::Reads, Particles>;
    using Writes = on_t<typename Stage::Writes, Particles>;
    Local<Scalar, union_t<Reads, Writes>> p;
    p.load(view, index, stored_t<Reads>{});
    auto const faults = Stage::run(p, grid, context);
    p.store(view, index, stored_t<Writes>{});
    return faults;
  }

  template <class Stage> void run(kind::Scatter) {
    lanes_.for_each(chunks(), [&](std::int64_t c, int) {
      auto& tile = work_.tiles[static_cast<std::size_t>(c)];
      tile.clear_to(box_of(c), needs_previous);
      TileWriter<T> const sums(tile);
      work_.faults[static_cast<std::size_t>(c)] |= each_particle<Stage>(c, sums);
    });
  }

  template <class Stage> void run(kind::NodeWise) {
    auto const& lattice = context_.lattice;
    lanes_.for_each(lattice.nodes[2], [&](std::int64_t k, int) {
      for (int j = 0; j < lattice.nodes[1]; ++j) {
        auto* row = work_.nodes.data() + lattice.index(0, j, static_cast<int>(k));
        sum_tiles<&Tile<T>::sums>(row, j, static_cast<int>(k));
        if constexpr (needs_previous)
          sum_tiles<&Tile<T>::previous>(
              work_.previous.velocities.data() + lattice.index(0, j, static_cast<int>(k)), j,
              static_cast<int>(k));
        for (int i = 0; i < lattice.nodes[0]; ++i)
          move_node<Stage>(row[i], i, j, static_cast<int>(k));
      }
    });
  }

  template <class Stage> void run(kind::Gather) {
    NodeReader<T> nodes{work_.nodes.data(), nullptr, context_.lattice};
    if constexpr (needs_previous) nodes.previous = work_.previous.velocities.data();
    lanes_.for_each(chunks(), [&](std::int64_t c, int) {
      work_.faults[static_cast<std::size_t>(c)] |= each_particle<Stage>(c, nodes);
    });
  }

  template <class Stage> void run(kind::Together) {
    auto const env = access();
    if constexpr (Scene::has_body) {
      if constexpr (requires { Stage::scratch_bytes(env, context_); })
        work_.reserve_scratch(Stage::scratch_bytes(env, context_));
      work_.faults_together |= Stage::run(Solo{}, env, context_, moved_nodes());
    } else {
      work_.faults_together |= Stage::run(Solo{}, env, context_, NoNodes{});
    }
  }

  template <class Stage> void run(kind::ItemWise) {
    auto const env = access();
    auto const grid = moved_nodes();
    int const count = Stage::count(env);
    lanes_.for_each((count + items_at_once - 1) / items_at_once, [&](std::int64_t some, int) {
      auto const first = static_cast<int>(some) * items_at_once;
      for (int i = first; i < min(first + items_at_once, count); ++i)
        Stage::run(env, i, context_, grid);
    });
  }
  // As the stages of a coupling see them.
  auto moved_nodes() {
    using Move = MoveNodes<typename Scene::Body, typename Scene::Effects>;
    return NodeAccess<T, Move, Ctx>{work_.nodes.data(), context_, work_.scratch.data()};
  }

  // The nodes of a chunk. A stencil's first node grows with the position, so the extreme positions will do.
  NodeBox box_of(std::int64_t c) const {
    using Shape = typename Scene::Body::Shape;
    auto const view = state_.template view<Particles>();
    std::int64_t const first = env_ * view.capacity + c * chunk_size;
    std::int64_t const count = min(chunk_size, live_ - c * chunk_size);
    Vec3<T> low, high;
    for (int a = 0; a < 3; ++a)
      extremes(view.template plane<particle::Position>(a) + first, count, low[a], high[a]);
    NodeBox box;
    box.include(Stencil<T, Shape>::at(context_.lattice, low).base, Shape::width);
    box.include(Stencil<T, Shape>::at(context_.lattice, high).base, Shape::width);
    return box;
  }
  // Eight at a time, which compilers make vectors of.
  static void extremes(T const* x, std::int64_t count, T& low, T& high) {
    T lows[8], highs[8];
    for (int l = 0; l < 8; ++l) lows[l] = highs[l] = x[0];
    std::int64_t i = 0;
    for (; i + 8 <= count; i += 8)
      for (int l = 0; l < 8; ++l) {
        lows[l] = min(lows[l], x[i + l]);
        highs[l] = max(highs[l], x[i + l]);
      }
    for (; i < count; ++i) {
      lows[0] = min(lows[0], x[i]);
      highs[0] = max(highs[0], x[i]);
    }
    low = lows[0], high = highs[0];
    for (int l = 1; l < 8; ++l) {
      low = min(low, lows[l]);
      high = max(high, highs[l]);
    }
  }

  template <std::vector<Quad<T>> Tile<T>::*member>
  void sum_tiles(Quad<T>* row, int j, int k) const {
    for (int i = 0; i < context_.lattice.nodes[0]; ++i) row[i] = quad<T>(0, 0, 0, 0);
    for (auto const& tile : work_.tiles) {
      if (!tile.box.has_row(j, k)) continue;
      auto const* from = (tile.*member).data() + tile.box.index(tile.box.low[0], j, k);
      for (int i = tile.box.low[0]; i < tile.box.high[0]; ++i)
        row[i] = row[i] + from[i - tile.box.low[0]];
    }
  }

  template <class Stage> void move_node(Quad<T>& node, int i, int j, int k) const {
    using Used = on_t<union_t<typename Stage::Reads, typename Stage::Writes>, Nodes>;
    Local<T, Used> n;
    n[node::Momentum{}] = vector_part(node);
    n[node::Mass{}] = node[3];
    n[node::Position{}] = context_.lattice.position(i, j, k);
    if constexpr (needs_previous)
      n[node::PreviousMomentum{}] = vector_part(
          work_.previous.velocities[static_cast<std::size_t>(context_.lattice.index(i, j, k))]);
    Stage::run(n, context_);
    node = quad(n[node::Velocity{}], n[node::Mass{}]);
    if constexpr (contains<Used, node::PreviousVelocity>)
      work_.previous.velocities[static_cast<std::size_t>(context_.lattice.index(i, j, k))] =
          quad(n[node::PreviousVelocity{}], T(0));
  }

  static constexpr int items_at_once = 256;

  Store& state_;
  std::int64_t env_;
  std::int64_t live_ = 0;
  Ctx context_;
  Work& work_;
  Lanes lanes_;
#if defined(MPMPBD_HAS_PACKS)
  bool packs_ = lanes_.kernels == Kernels::widest && has_wide_vectors();
#endif
};

}  // namespace mpmpbd
