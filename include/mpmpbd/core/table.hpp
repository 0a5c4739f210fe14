// The stored fields of one domain for all environments: one plane per component, slot fastest.
//
// Logical shape (env, slot, component); index of an item = env * capacity + slot, 64 bits.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <mpmpbd/core/field.hpp>

namespace mpmpbd {

namespace detail {
template <class T, class F> struct Plane { element_t<F, T>* data = nullptr; };
}  // namespace detail

// Where the numbers are: a pointer per field, cheap to copy, passed to kernels by value.
template <class T, class List> struct View;
template <class T, class... Fs> struct View<T, Fields<Fs...>> : detail::Plane<T, Fs>... {
  using Scalar = T;
  using List = Fields<Fs...>;

  std::int64_t capacity = 0;  // slots per environment
  std::int64_t stride = 0;    // items from one component to the next: environments * capacity

  template <class F> MPMPBD_HD auto* plane(int component = 0) const {
    if constexpr (contains<List, F>) {
      return static_cast<detail::Plane<T, F> const&>(*this).data + component * stride;
    } else {
      FieldIsNotDeclared<F, List> refuse;
      return &refuse;
    }
  }
  template <class F> MPMPBD_HD value_t<F, T> get(std::int64_t index) const {
    auto const* from = plane<F>() + index;
    if constexpr (F::components == 1) {
      return *from;
    } else {
      value_t<F, T> v;
      for (int c = 0; c < F::components; ++c) v[c] = from[c * stride];
      return v;
    }
  }
  template <class F> MPMPBD_HD void set(std::int64_t index, value_t<F, T> const& v) const {
    auto* to = plane<F>() + index;
    if constexpr (F::components == 1) {
      *to = v;
    } else {
      for (int c = 0; c < F::components; ++c) to[c * stride] = v[c];
    }
  }
};

// One field of one environment, indexed by slot: how code that walks along a thread reads and writes.
template <class View_, class F> struct Row {
  View_ view;
  std::int64_t first;
  MPMPBD_HD auto operator()(std::int64_t slot) const { return view.template get<F>(first + slot); }
  MPMPBD_HD void set(std::int64_t slot, value_t<F, typename View_::Scalar> const& v) const {
    view.template set<F>(first + slot, v);
  }
};

// The owner of a table on the host. `live[env]` slots are in use.
template <class T, class Domain_, class List> class Table;
template <class T, class Domain_, class... Fs> class Table<T, Domain_, Fields<Fs...>> {
 public:
  using Domain = Domain_;
  using List = Fields<Fs...>;
  static_assert(((Fs::stored && std::is_same_v<typename Fs::Domain, Domain>)&&...));

  // Elements of one item, and their size.
  static constexpr int components = (Fs::components + ... + 0);
  static constexpr std::size_t bytes_per_item =
      ((Fs::components * sizeof(element_t<Fs, T>)) + ... + 0);

  Table() = default;
  Table(std::int64_t environments, std::int64_t capacity) { resize(environments, capacity); }

  void resize(std::int64_t environments, std::int64_t capacity) {
    environments_ = environments;
    capacity_ = capacity;
    live_.assign(static_cast<std::size_t>(environments), 0);
    (planes<Fs>().assign(static_cast<std::size_t>(Fs::components * environments * capacity), {}),
     ...);
  }

  std::int64_t environments() const { return environments_; }
  std::int64_t capacity() const { return capacity_; }
  std::int64_t live(std::int64_t env) const { return live_[static_cast<std::size_t>(env)]; }
  // Sets how many slots of an environment are in use; more than the capacity is refused, and an environment that is not there.
  void set_live(std::int64_t env, std::int64_t count) {
    check_live(env, count);
    live_[static_cast<std::size_t>(env)] = count;
  }
  // Throws std::out_of_range where set_live would.
  void check_live(std::int64_t env, std::int64_t count) const {
    if (env < 0 || env >= environments_)
      throw std::out_of_range("mpmpbd: environment " + std::to_string(env) + " of domain '" +
                              std::string(Domain::name.view()) + "' asked for; there are 0 to " +
                              std::to_string(environments_ - 1));
    if (count < 0 || count > capacity_)
      throw std::out_of_range(
          "mpmpbd: " + std::to_string(count) + " items of domain '" +
          std::string(Domain::name.view()) + "' asked for, capacity is " +
          std::to_string(capacity_) +
          " per environment; give a larger capacity when the simulation is made");
  }
  // Sets all fields of some slots of an environment to zero.
  void clear(std::int64_t env, std::int64_t first, std::int64_t count) {
    auto const clear_field = [&]<class F>(F) {
      auto& all = planes<F>();
      for (int c = 0; c < F::components; ++c)
        std::fill_n(all.begin() + (c * environments_ + env) * capacity_ + first, count,
                    element_t<F, T>{});
    };
    (clear_field(Fs{}), ...);
  }

  View<T, List> view() {
    View<T, List> v;
    v.capacity = capacity_;
    v.stride = environments_ * capacity_;
    ((static_cast<detail::Plane<T, Fs>&>(v).data = planes<Fs>().data()), ...);
    return v;
  }
  template <class F> value_t<F, T> get(std::int64_t env, std::int64_t slot) const {
    return const_cast<Table*>(this)->view().template get<F>(env * capacity_ + slot);
  }
  template <class F> void set(std::int64_t env, std::int64_t slot, value_t<F, T> const& v) {
    view().template set<F>(env * capacity_ + slot, v);
  }

  // Copies every field and the live count of one environment from another table's environment.
  void copy_environment(std::int64_t to, Table const& source, std::int64_t from) {
    if (source.capacity_ != capacity_)
      throw std::invalid_argument("mpmpbd: environments of capacity " +
                                  std::to_string(source.capacity_) + " and " +
                                  std::to_string(capacity_) + " cannot be copied into each other");
    (copy_plane<Fs>(to, source, from), ...);
    live_[static_cast<std::size_t>(to)] = source.live(from);
  }

  template <class F> std::vector<element_t<F, T>>& planes() {
    return static_cast<Held<F>&>(held_).numbers;
  }
  template <class F> std::vector<element_t<F, T>> const& planes() const {
    return static_cast<Held<F> const&>(held_).numbers;
  }

 private:
  template <class F> struct Held { std::vector<element_t<F, T>> numbers; };
  struct All : Held<Fs>... {};

  template <class F> void copy_plane(std::int64_t to, Table const& source, std::int64_t from) {
    for (int c = 0; c < F::components; ++c) {
      auto const* s = source.planes<F>().data() + (c * source.environments_ + from) * capacity_;
      auto* t = planes<F>().data() + (c * environments_ + to) * capacity_;
      for (std::int64_t i = 0; i < capacity_; ++i) t[i] = s[i];
    }
  }

  std::int64_t environments_ = 0;
  std::int64_t capacity_ = 0;
  std::vector<std::int64_t> live_;
  All held_;
};

}  // namespace mpmpbd
