// The whole state of a run: one table per domain, holding the stored fields that the policies declare.
//
// Nothing else may hold history, so reset, clone and checkpoint are copies of these tables and exact.
#pragma once

#include <array>
#include <string_view>

#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/core/status.hpp>
#include <mpmpbd/core/table.hpp>

namespace mpmpbd {

namespace detail {
template <class Out, class List> struct DomainsOf { using type = Out; };
template <class... Ds, class F, class... Fs>
struct DomainsOf<TypeList<Ds...>, Fields<F, Fs...>>
    : DomainsOf<std::conditional_t<(std::is_same_v<typename F::Domain, Ds> || ...), TypeList<Ds...>,
                                   TypeList<Ds..., typename F::Domain>>,
                Fields<Fs...>> {};
template <class T, class List, class Domains> class Tables;
template <class T, class List, class... Ds>
class Tables<T, List, TypeList<Ds...>> : public Table<T, Ds, on_t<List, Ds>>... {};
}  // namespace detail

// The domains that a field list touches, in order of first mention.
template <class List> using domains_t = typename detail::DomainsOf<TypeList<>, List>::type;

// Parameters of policy P as a field of the environment.
template <class P>
struct ParametersField
    : Field<P::name, "SI", Numbers<static_cast<int>(parameter_count<P>)>, Environments> {};

// How many slots a domain has per environment.
struct Capacity {
  std::string_view domain;
  std::int64_t slots;
};

template <class T, class List_> class State {
 public:
  using Scalar = T;
  using List = stored_t<List_>;
  using Domains = domains_t<List>;

  template <class Domain>
  static constexpr bool has =
      []<class... Ds>(TypeList<Ds...>) { return (std::is_same_v<Domain, Ds> || ...); }(Domains{});

  explicit State(std::int64_t environments = 0) : environments_(environments) {}

  std::int64_t environments() const { return environments_; }

  template <class Domain> auto& table() {
    return static_cast<Table<T, Domain, on_t<List, Domain>>&>(tables_);
  }
  template <class Domain> auto const& table() const {
    return static_cast<Table<T, Domain, on_t<List, Domain>> const&>(tables_);
  }
  template <class Domain> auto view() { return table<Domain>().view(); }

  template <class F> value_t<F, T> get(std::int64_t env, std::int64_t slot = 0) const {
    return table<typename F::Domain>().template get<F>(env, slot);
  }
  template <class F> void set(std::int64_t env, std::int64_t slot, value_t<F, T> const& v) {
    table<typename F::Domain>().template set<F>(env, slot, v);
  }
  template <class F> void set(std::int64_t env, value_t<F, T> const& v) { set<F>(env, 0, v); }

  // Copies one environment, all domains; the other environments are not touched.
  void copy_environment(std::int64_t to, State const& source, std::int64_t from) {
    for_each_type(Domains{}, [&]<class D>(std::type_identity<D>) {
      table<D>().copy_environment(to, source.template table<D>(), from);
    });
  }

  // Parameters of policy P for one environment.
  template <class P> parameters_t<P, T> parameters(std::int64_t env) const {
    parameters_t<P, T> k{};
    if constexpr (parameter_count < P >> 0) {
      auto const flat = get_flat<ParametersField<P>>(env);
      auto* numbers = reinterpret_cast<T*>(&k);
      for (std::size_t i = 0; i < parameter_count<P>; ++i) numbers[i] = flat[i];
    }
    return k;
  }
  template <class P> void set_parameters(std::int64_t env, parameters_t<P, T> const& k) {
    if constexpr (parameter_count < P >> 0) {
      auto& plane = table<Environments>().template planes<ParametersField<P>>();
      auto const* numbers = reinterpret_cast<T const*>(&k);
      for (std::size_t i = 0; i < parameter_count<P>; ++i)
        plane[i * static_cast<std::size_t>(environments_) + static_cast<std::size_t>(env)] =
            numbers[i];
    }
  }

 private:
  template <class F> auto get_flat(std::int64_t env) const {
    auto const& plane = table<Environments>().template planes<F>();
    std::array<T, static_cast<std::size_t>(F::components)> flat;
    for (std::size_t i = 0; i < flat.size(); ++i)
      flat[i] = plane[i * static_cast<std::size_t>(environments_) + static_cast<std::size_t>(env)];
    return flat;
  }

  std::int64_t environments_ = 0;
  detail::Tables<T, List, Domains> tables_;
};

}  // namespace mpmpbd
