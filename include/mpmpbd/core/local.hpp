// One item (a particle, a node) in registers: loaded once before a stage, stored once after it.
#pragma once

#include <mpmpbd/core/field.hpp>

namespace mpmpbd {

namespace detail {
template <class T, class F> struct Register { value_t<F, T> value; };
}  // namespace detail

template <class T, class List> struct Local;
template <class T, class... Fs> struct Local<T, Fields<Fs...>> : detail::Register<T, Fs>... {
  using Scalar = T;
  using List = Fields<Fs...>;

  template <class F> MPMPBD_HD constexpr auto& operator[](F) {
    if constexpr (contains<List, F>) {
      return static_cast<detail::Register<T, F>&>(*this).value;
    } else {
      FieldIsNotDeclared<F, List> refuse;
      return refuse;
    }
  }
  template <class F> MPMPBD_HD constexpr auto const& operator[](F) const {
    if constexpr (contains<List, F>) {
      return static_cast<detail::Register<T, F> const&>(*this).value;
    } else {
      FieldIsNotDeclared<F, List> refuse;
      return refuse;
    }
  }

  // Loads the stored fields of `Wanted` from a view.
  template <class View, class... Ws>
  MPMPBD_HD void load([[maybe_unused]] View const& view, [[maybe_unused]] std::int64_t index,
                      Fields<Ws...>) {
    ((static_cast<detail::Register<T, Ws>&>(*this).value = view.template get<Ws>(index)), ...);
  }
  template <class View, class... Ws>
  MPMPBD_HD void store([[maybe_unused]] View const& view, [[maybe_unused]] std::int64_t index,
                       Fields<Ws...>) const {
    (view.template set<Ws>(index, static_cast<detail::Register<T, Ws> const&>(*this).value), ...);
  }
};

}  // namespace mpmpbd
