// What happens to a particle between two visits to the grid: scatter, gather, or gather and scatter at once.
#pragma once

#include <mpmpbd/backend/cuda/arena.cuh>
#include <mpmpbd/backend/cuda/launch.cuh>
#include <mpmpbd/backend/cuda/previous_grid.cuh>
#include <mpmpbd/backend/cuda/tile.cuh>
#include <mpmpbd/backend/cuda/together.cuh>

namespace mpmpbd::cuda {

// What a fused pass has to load and keep. A field that gather overwrites unread is not loaded, and with `brief` it stays in
// registers: that saves a tenth of the time, and leaves the velocities of its beginning to a step that is stopped on the way.
template <class GatherStage, class ScatterStage, bool brief> struct Fused {
  using Used = on_t<union_t<typename GatherStage::Reads, typename GatherStage::Writes,
                            typename ScatterStage::Reads, typename ScatterStage::Writes>,
                    Particles>;
  using Loads =
      stored_t<on_t<union_t<typename GatherStage::Reads,
                            minus_t<typename ScatterStage::Reads, typename GatherStage::Writes>>,
                    Particles>>;
  using Changed = union_t<typename GatherStage::Writes, typename ScatterStage::Writes>;
  using Overwritten = minus_t<typename GatherStage::Writes, typename GatherStage::Reads>;
  using Keeps =
      stored_t<on_t<std::conditional_t<brief, minus_t<Changed, Overwritten>, Changed>, Particles>>;
};
// The same of one stage alone.
template <class Stage> struct Single {
  using Reads = on_t<typename Stage::Reads, Particles>;
  using Keeps = stored_t<on_t<typename Stage::Writes, Particles>>;
  using Used = union_t<Reads, on_t<typename Stage::Writes, Particles>>;
  using Loads = stored_t<Reads>;
};

// Tells the memory of the device that the same fields of the item so many slots `ahead` are loaded soon: they lie in its
// cache by then. It has the addresses of this item, and may be behind the last one (see announced_bytes).
template <int ahead, class View_, class... Fs>
__device__ __forceinline__ void announce(View_ const& view, std::int64_t index, Fields<Fs...>) {
  auto const each_plane = [&]<class F>(F) {
    [[maybe_unused]] auto const* const item = view.template plane<F>() + index;
    static_assert(ahead * sizeof(*item) <= announced_bytes);
    for (int c = 0; c < F::components; ++c) {
#if defined(__CUDA_ARCH__)
      asm volatile("prefetch.global.L2 [%0+%1];"
                   :
                   : "l"(item + c * view.stride), "n"(ahead * static_cast<int>(sizeof(*item))));
#endif
    }
  };
  (each_plane(Fs{}), ...);
}

// Faults of a substep, and those that belong to the next one.
struct Met {
  unsigned now = 0, next = 0;
};

// `ahead`: announces what as many slots ahead is visited next; 0: does not.
template <class Scene, class T, int ahead = 0> struct ParticlePasses {
  using Body = typename Scene::Body;
  using P2G = ParticlesToGrid<Body, typename Scene::Effects>;
  using G2P = GridToParticles<Body, typename Scene::Effects>;
  // A coupling may lose an environment in mid-step, which then holds one moment.
  static constexpr bool brief = !detail::couples<Scene>;
  using Scattering = Single<P2G>;
  using Gathering = Single<G2P>;
  using Both = Fused<G2P, P2G, brief>;
  using Ctx = typename StepRecord<Scene, T>::Ctx;

  Launch<Scene, T> const& launch;
  Arena<T> arena;
  FixedPoint<T> unit;
  Arena<T> before{};  // where the transfer needs the previous grid

  // `to`: which way the sums go, and whether this thread has a particle.
  template <class To = ToGrid>
  __device__ __forceinline__ void scatter(std::int64_t index, Ctx const& next, Met& met,
                                          To const& to = {}) const {
    visit<Scattering>(
        index, to.has_particle, [](auto&) {}, [&](auto& p) { add(p, next, met, to); });
  }
  // And looks at it before: one that is not finite has no nodes.
  __device__ __forceinline__ void look_and_scatter(std::int64_t index, Ctx const& next,
                                                   ParticleLook<Scene, T> const& look,
                                                   Findings<T>& found, Met& met) const {
    bool finite = false;
    visit<Scattering>(
        index, true, [&](auto& p) { finite = look.at(p, index, next, found); },
        [&](auto& p) { add(p, next, met, ToGrid{finite}); });
  }
  __device__ __forceinline__ void gather(std::int64_t index, Ctx const& now, Met& met) const {
    visit<Gathering>(
        index, true, [&](auto& p) { met.now |= G2P::run(p, velocities(), now); }, [](auto&) {});
  }
  template <class To = ToGrid>
  __device__ __forceinline__ void gather_and_scatter(std::int64_t index, Ctx const& now,
                                                     Ctx const& next, Met& met,
                                                     To const& to = {}) const {
    visit<Both>(
        index, to.has_particle, [&](auto& p) { met.now |= G2P::run(p, velocities(), now); },
        [&](auto& p) { add(p, next, met, to); });
  }

 private:
  static constexpr bool looks_back = Body::Transfer::needs_previous_grid;
  __device__ __forceinline__ auto sums(T start) const {
    if constexpr (looks_back)
      return SumsOfBoth<T>{{arena, launch.lattice, unit, start}, before};
    else
      return SumsOfArena<T>{arena, launch.lattice, unit, start};
  }
  __device__ __forceinline__ auto velocities() const {
    if constexpr (looks_back)
      return VelocitiesOfBoth<T>{{arena, launch.lattice}, before};
    else
      return VelocitiesOfArena<T>{arena, launch.lattice};
  }
  template <class P, class To>
  __device__ __forceinline__ void add(P& p, Ctx const& next, Met& met, To const& to) const {
    to(p, sums(start_of<T>(p[particle::Position{}], next.tick.step)),
       [&](auto const& where) { met.next |= P2G::run(p, where, next); });
  }
  // Where particles are, which a block of so many threads that it announces reads for each of them, by an offset of zero that
  // nvcc does not know: it has no registers to keep that in, and local memory is far away.
  __device__ __forceinline__ auto const& particles([[maybe_unused]] std::int64_t index) const {
    auto const& view = launch.particles().view;
    if constexpr (ahead > 0)
      return (&view)[index >> 63];  // the first
    else
      return view;
  }
  // Moves a particle, if there is one, and adds it; threads without one go along.
  template <class Pass, class Move, class Add>
  __device__ __forceinline__ void visit(std::int64_t index, bool has_particle, Move const& move,
                                        Add const& add) const {
    auto const& view = particles(index);
    Local<T, typename Pass::Used> p{};  // threads without a particle hold rubbish otherwise
    if (has_particle) {
      p.load(view, index, typename Pass::Loads{});
      if constexpr (ahead > 0) announce<ahead>(view, index, typename Pass::Loads{});
      move(p);
    }
    add(p);
    if (has_particle) p.store(view, index, typename Pass::Keeps{});
  }
};

}  // namespace mpmpbd::cuda
