// The tables of a run on the device: planes by value, and how many slots of each environment are in use.
#pragma once

#include <mpmpbd/core/state.hpp>
#include <mpmpbd/pbd/access.hpp>

namespace mpmpbd::cuda {

template <class T, class List, class Domains> struct Tables;
template <class T, class List, class... Ds> struct Tables<T, List, TypeList<Ds...>> {
  using Stored = List;
  using Domains = TypeList<Ds...>;
  template <class D> using ViewOf = View<T, on_t<List, D>>;
  template <class D> struct Held {
    ViewOf<D> view;
    std::int64_t* live;
  };
  struct All : Held<Ds>... {};
  All all;

  template <class D> MPMPBD_HD auto const& of() const { return static_cast<Held<D> const&>(all); }
  template <class D> auto& of() { return static_cast<Held<D>&>(all); }

  // The fields of one environment, as stages and tasks see them.
  MPMPBD_HD auto environment(std::int64_t env) const {
    return EnvironmentAccess<T, DomainAccess<Ds, ViewOf<Ds>>...>{
        access_domain<Ds>(of<Ds>().view, env, of<Ds>().live[env])...};
  }

  // One environment becomes that of another set of tables; the threads of a block share the work.
  __device__ void copy_environment(std::int64_t to, Tables const& source, std::int64_t from) const {
    (copy_domain<Ds>(to, source, from), ...);
  }

 private:
  template <class D>
  __device__ void copy_domain(std::int64_t to, Tables const& source, std::int64_t from) const {
    copy_fields<D>(on_t<List, D>{}, to, source, from);
    if (threadIdx.x == 0) of<D>().live[to] = source.of<D>().live[from];
  }
  template <class D, class... Fs>
  __device__ void copy_fields(Fields<Fs...>, std::int64_t to, Tables const& source,
                              std::int64_t from) const {
    (copy_field<D, Fs>(to, source, from), ...);
  }
  template <class D, class F>
  __device__ void copy_field(std::int64_t to, Tables const& source, std::int64_t from) const {
    auto const &view = of<D>().view, &other = source.of<D>().view;
    for (int c = 0; c < F::components; ++c) {
      auto* const t = view.template plane<F>(c) + to * view.capacity;
      auto const* const s = other.template plane<F>(c) + from * other.capacity;
      for (std::int64_t i = threadIdx.x; i < view.capacity; i += blockDim.x) t[i] = s[i];
    }
  }
};

template <class Scene, class T>
using TablesOf = Tables<T, typename State<T, typename Scene::StateFields>::List,
                        typename State<T, typename Scene::StateFields>::Domains>;

}  // namespace mpmpbd::cuda
