// The list of ready-made scenes.
#include <array>
#include <stdexcept>

#include <mpmpbd/catalog.hpp>
#include <mpmpbd/scene/plan.hpp>

namespace mpmpbd::catalog {

namespace {
template <class Scene> std::string plan_of() { return plan<Scene, Serial, float>(); }
template <class Scene> constexpr Entry about(std::string_view name, std::string_view text) {
  return {name, text, &plan_of<Scene>};
}
constexpr std::array all{
    about<Tissue>("tissue", "a block of soft tissue on a floor that it sticks to"),
    about<Suture>("suture", "threads that resist stretch and bending"),
    about<Suturing>("suturing", "soft tissue, an arc needle and the thread behind it"),
};
}  // namespace

std::span<Entry const> entries() { return all; }

Entry const& entry(std::string_view name) {
  std::string known;
  for (auto const& one : all) {
    if (one.name == name) return one;
    known += (known.empty() ? "" : ", ") + std::string(one.name);
  }
  throw std::out_of_range("mpmpbd catalog: no scene '" + std::string(name) + "'; there are " +
                          known);
}

}  // namespace mpmpbd::catalog
