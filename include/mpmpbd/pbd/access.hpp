// One environment as a stage sees it: fields by slot, and how many slots of a domain are in use.
//
// Stages of rods ask of it `get<F>(slot)`, `set<F>(slot, value)`, `live<Domain>()` and `Scalar`, so any
// type that has these will do; this one is made of the views of core/table.hpp.
#pragma once

#include <mpmpbd/core/role.hpp>
#include <mpmpbd/core/table.hpp>

namespace mpmpbd {

// The slots of one domain that belong to one environment.
template <class Domain_, class View_> struct DomainAccess {
  using Domain = Domain_;
  using List = typename View_::List;
  View_ view;
  std::int64_t first = 0;  // index of slot 0
  std::int64_t count = 0;  // slots in use
};

template <class Domain, class View_>
MPMPBD_HD DomainAccess<Domain, View_> access_domain(View_ const& view, std::int64_t env,
                                                    std::int64_t live) {
  return {view, env * view.capacity, live};
}

template <class T, class... Domains> struct EnvironmentAccess : Domains... {
  using Scalar = T;
  template <class F> static constexpr bool has = (contains<typename Domains::List, F> || ...);

  template <class F> MPMPBD_HD value_t<F, T> get(std::int64_t slot) const {
    auto const& d = part<typename F::Domain>(*this);
    return d.view.template get<F>(d.first + slot);
  }
  template <class F> MPMPBD_HD void set(std::int64_t slot, value_t<F, T> const& v) const {
    auto const& d = part<typename F::Domain>(*this);
    d.view.template set<F>(d.first + slot, v);
  }
  template <class Domain> MPMPBD_HD std::int64_t live() const { return part<Domain>(*this).count; }
  // A whole domain: its view, the index of its first slot, how many are in use.
  template <class Domain> MPMPBD_HD auto const& domain() const { return part<Domain>(*this); }

 private:
  template <class Domain, class View_>
  static MPMPBD_HD DomainAccess<Domain, View_> const& part(DomainAccess<Domain, View_> const& d) {
    return d;
  }
};

// One field of an environment as a row: row(slot), row.set(slot, value).
template <class Env, class F> struct FieldRow {
  Env env;
  MPMPBD_HD auto operator()(std::int64_t slot) const { return env.template get<F>(slot); }
  MPMPBD_HD void set(std::int64_t slot, value_t<F, typename Env::Scalar> const& v) const {
    env.template set<F>(slot, v);
  }
};

// The domains of a list, all taken from one environment of a store (core/state.hpp).
template <class Store, class... Ds>
auto access_environment(Store& store, std::int64_t env, TypeList<Ds...>) {
  using T = typename Store::Scalar;
  return EnvironmentAccess<T, DomainAccess<Ds, decltype(store.template view<Ds>())>...>{
      access_domain<Ds>(store.template view<Ds>(), env, store.template table<Ds>().live(env))...};
}

}  // namespace mpmpbd
