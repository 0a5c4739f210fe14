// What a file from anywhere may do: it is taken, and is then valid, or it is refused by the library's own error.
//
// Each function gives bytes to one reader and says whether they were taken. Any other exception, and any property of
// what was taken that does not hold, leaves it: a finding. The fuzzers call them, and the test that replays their
// corpus (tests/io/fuzz_corpus.cpp).
#pragma once

#include <map>
#include <utility>

#include <mpmpbd/io/config.hpp>
#include <mpmpbd/io/ply.hpp>
#include <mpmpbd/io/state_file.hpp>
#include <mpmpbd/io/summary.hpp>
#include <mpmpbd/rl/suturing/config.hpp>
#include <mpmpbd/surface/sheet_mesh.hpp>
#include <mpmpbd/surface/tip.hpp>

#include "io/scratch.hpp"

namespace fuzz {

using namespace mpmpbd;

struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};
inline void require(bool holds, char const* property) {
  if (!holds) throw Finding(property);
}

// A file of these bytes; every call writes the same one.
inline std::filesystem::path file_of(std::string_view bytes) {
  static Scratch const scratch;
  auto const path = scratch / "input";
  io::write_file(path, bytes);
  return path;
}

// A scene, and the settings of the task beside it: TOML.
inline bool scene_file(std::string const& text) {
  using Config = rl::SuturingTaskConfig;
  Config c;
  try {
    c = io::parse_config<Config>(text, "scene.toml");
  } catch (ConfigError const& error) {
    for (auto const& message : error.messages) {
      require(message.starts_with("scene.toml"), "a complaint says where");
      require(message.find('\0') == std::string::npos, "a complaint is told to its end");
    }
    return false;
  }
  check_config(c);
  require(io::parse_config<Config>(io::config_text(c), "written") == c,
          "written, it reads the same");
  auto const& scene = c.scene;
  require(scene.steps() >= 1 && scene.least_substeps() >= 1, "it takes steps");
  require(scene.tissue.point_count() >= 1, "it has tissue");
  for (int a = 0; a < 3; ++a) require(scene.domain.nodes()[a] >= 5, "it has a grid");
  require(is_finite(scene.script().end().position), "the hand comes to an end");
  return true;
}

// Numbers of both kinds, three domains.
using FuzzedState = State<float, Fields<sheet::Position, sheet::Corners, tip::Cap>>;

// The bytes as a state file with the checksum that they need; what does not begin as one is taken for what
// follows the description.
inline std::string state_bytes(std::string_view bytes) {
  mpmpbd::detail::ByteWriter out;
  if (!bytes.starts_with(state_file_magic)) {
    out.put_bytes(state_file_magic.data(), state_file_magic.size());
    out.put(state_file_version);
    out.put_text(mpmpbd::detail::describe_state<FuzzedState>());
  }
  out.put_bytes(bytes.data(), bytes.size());
  out.put(mpmpbd::detail::fnv1a(out.bytes.data(), out.bytes.size()));
  return {out.bytes.data(), out.bytes.size()};
}

inline bool state_file(std::string_view bytes) {
  auto const file = state_bytes(bytes);
  auto const path = file_of(file).string();
  FuzzedState state;
  try {
    state = read_state_file<FuzzedState>(path);
  } catch (std::runtime_error const& error) {
    require(std::string_view(error.what()).find("nothing was changed") != std::string_view::npos,
            "a refusal says so");
    return false;
  }
  for_each_type(FuzzedState::Domains{}, [&]<class D>(std::type_identity<D>) {
    auto const& table = state.table<D>();
    for (std::int64_t e = 0; e < state.environments(); ++e)
      require(table.live(e) >= 0 && table.live(e) <= table.capacity(), "live items have a slot");
    auto const items = static_cast<std::size_t>(state.environments() * table.capacity());
    for_each_field(typename std::remove_cvref_t<decltype(table)>::List{}, [&]<class F>(F) {
      require(table.template planes<F>().size() == F::components * items, "planes are whole");
    });
  });
  write_state_file(path, state);
  require(io::read_file(path) == file, "written, it is the same");
  return true;
}

// Every edge has two triangles, which run along it in opposite directions.
inline bool is_closed(SheetMesh<double> const& mesh) {
  std::map<std::pair<std::int64_t, std::int64_t>, int> runs;
  for (auto const& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) ++runs[{t[c], t[(c + 1) % 3]}];
  for (auto const& [edge, count] : runs) {
    auto const back = runs.find({edge.second, edge.first});
    if (count != 1 || back == runs.end() || back->second != 1) return false;
  }
  return true;
}

// A triangle mesh, PLY, and whether it can be the surface of a body.
inline bool surface_file(std::string_view bytes) {
  SheetMesh<double> mesh;
  try {
    auto const ply = io::read_ply(file_of(bytes));
    auto const &x = ply["x"], &y = ply["y"], &z = ply["z"];
    for (auto const& column : ply.columns)
      require(column.values.size() == x.size(), "columns are equally long");
    for (std::size_t i = 0; i < x.size(); ++i) mesh.positions.push_back(vec(x[i], y[i], z[i]));
    for (auto const& t : ply.triangles) mesh.triangles.push_back({{t[0], t[1], t[2]}});
  } catch (io::FileError const& error) {
    require(std::string_view(error.what()).size() > 20, "a refusal says why");
    return false;
  }
  for (auto const& t : mesh.triangles)
    for (int c = 0; c < 3; ++c)
      require(t[c] >= 0 && t[c] < std::int64_t(mesh.positions.size()), "corners are vertices");
  try {
    check_sheet(mesh);
  } catch (std::invalid_argument const&) { return false; }
  require(is_closed(mesh), "a sheet is closed");
  auto const volume = enclosed_volume(sheet_of(mesh));
  require(volume > 0 && is_finite(volume), "a sheet encloses something");
  return true;
}

// What a run told, JSON.
inline bool summary_file(std::string_view bytes) {
  io::Json json;
  try {
    json = io::read_json(file_of(bytes));
  } catch (io::FileError const&) { return false; }
  auto const path = file_of("");
  io::write_json(path, json);
  require(io::read_json(path) == json, "written, it reads the same");
  return true;
}

}  // namespace fuzz
