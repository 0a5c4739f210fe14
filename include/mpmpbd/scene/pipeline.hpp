// A list of stages, checked for data flow when it is composed: nothing is read before it is written.
#pragma once

#include <mpmpbd/core/field.hpp>
#include <mpmpbd/core/role.hpp>

namespace mpmpbd {

namespace detail {
template <class F, class Stage> struct ReadBeforeWritten {
  static_assert(
      !std::is_same_v<F, F>,
      "mpmpbd Pipeline: a stage reads a field that is neither state nor written by an earlier "
      "stage; move the stage later, or add the stage that writes it (field and stage are the "
      "template arguments of ReadBeforeWritten)");
};
template <class Known, class Stage, class Reads> struct ReadsAreKnown;
template <class Known, class Stage, class... Rs> struct ReadsAreKnown<Known, Stage, Fields<Rs...>> {
  template <class R> static consteval bool one() {
    if constexpr (!contains<Known, R>) {
      ReadBeforeWritten<R, Stage> refuse;
      (void)refuse;
      return false;
    } else {
      return true;
    }
  }
  static constexpr bool ok = (one<Rs>() && ... && true);
};
template <class Known, class... Stages> struct DataFlow : std::true_type {};
template <class Known, class S, class... Stages>
struct DataFlow<Known, S, Stages...>
    // Within a stage, parts run in order: what the stage writes it may also read as transient.
    : std::bool_constant<
          ReadsAreKnown<union_t<Known, typename S::Writes>, S, typename S::Reads>::ok &&
          DataFlow<union_t<Known, typename S::Writes>, Stages...>::value> {};
}  // namespace detail

template <class... Stages_> struct Pipeline {
  using Stages = TypeList<Stages_...>;
  using AllFields = union_t<typename Stages_::Reads..., typename Stages_::Writes...>;
  // Whether every read finds its field: in the state, or written by an earlier stage.
  template <class StateFields>
  static constexpr bool flows = detail::DataFlow<StateFields, Stages_...>::value;
};

}  // namespace mpmpbd
