// The plan of a scene: what runs, in which order, on what, and what it stores - read off the very type
// lists that are executed.
#pragma once

#include <fmt/format.h>

#include <string>

#include <mpmpbd/backend/host.hpp>
#include <mpmpbd/scene/scene.hpp>

namespace mpmpbd {

namespace detail {

template <class... Fs> std::string field_names(Fields<Fs...>) {
  std::string text;
  ((text +=
    fmt::format("{}{}.{}", text.empty() ? "" : ", ", Fs::Domain::name.view(), Fs::name.view())),
   ...);
  return text.empty() ? "-" : text;
}

template <class... Ps> std::string policy_names(TypeList<Ps...>) {
  std::string text;
  ((text += (text.empty() ? "" : " + ") + std::string(Ps::name.view())), ...);
  return text.empty() ? "-" : text;
}

template <class T, class Domain, class List> std::string table_plan() {
  using Stored = Table<T, Domain, List>;
  auto text = fmt::format("  {}: {} B each\n", Domain::name.view(), Stored::bytes_per_item);
  for_each_field(List{}, [&]<class F>(F) {
    text += fmt::format("    {:<14} [{}] x{}\n", F::name.view(), F::unit.view(), F::components);
  });
  return text;
}

template <class Stage> std::string stage_plan(int number) {
  return fmt::format("  {} {:<18} {:<10} {}\n      reads  {}\n      writes {}\n", number,
                     Stage::Kind::name.view(), Stage::name.view(),
                     policy_names(typename Stage::Parts{}), field_names(typename Stage::Reads{}),
                     field_names(typename Stage::Writes{}));
}

}  // namespace detail

// Bytes of grid scratch per node; resident on a device, a coupling keeps a copy more.
template <class Scene, class Backend, class T> constexpr std::size_t bytes_per_node() {
  using Extra = typename Scene::NodeFields;
  constexpr std::size_t quads = contains<Extra, node::PreviousVelocity> ? 2 : 1;
  return Backend::grids * quads * sizeof(Quad<T>);
}

// Stages in order with what they read and write, stored fields and bytes by domain, for a scene, back
// end and scalar type. Golden plans of the catalogue are architecture tests.
template <class Scene, class Backend = Serial, class T = float> std::string plan() {
  auto text = fmt::format("back end: {}, {}\nstate\n", Backend::name.view(),
                          sizeof(T) == 4 ? "float" : "double");
  using Stored = State<T, typename Scene::StateFields>;
  for_each_type(typename Stored::Domains{}, [&]<class D>(std::type_identity<D>) {
    text += detail::table_plan<T, D, on_t<typename Stored::List, D>>();
  });
  text += "scratch\n";
  if constexpr (Scene::has_body)
    text += fmt::format("  node: {} B each\n", bytes_per_node<Scene, Backend, T>());
  text += "substep\n";
  int number = 0;
  for_each_type(typename Scene::Substep::Stages{},
                [&]<class S>(std::type_identity<S>) { text += detail::stage_plan<S>(++number); });
  return text;
}

}  // namespace mpmpbd
