// What the camera sees of a suturing scene: taken from a simulation as a few numbers, drawn later.
#pragma once

#include <array>
#include <vector>

#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/render/rasteriser.hpp>
#include <mpmpbd/render/tube.hpp>

namespace mpmpbd::suturing {

// A moment of one environment: enough to draw it, small enough to keep all of a video.
struct Moment {
  double time = 0.0;                   // [s]
  std::vector<Vec3<float>> surface{};  // vertices of the tissue's sheet [m]
  std::vector<Vec3<float>> thread{};   // beads [m]
  Pose<float> needle{};

  template <class Sim> static Moment of(Sim const& sim, std::int64_t env, double time) {
    auto const& state = sim.state();
    Moment m;
    m.time = time;
    for (std::int64_t i = 0; i < state.template table<SheetVertices>().live(env); ++i)
      m.surface.push_back(cast<float>(state.template get<sheet::Position>(env, i)));
    for (std::int64_t k = 0; k < state.template table<Beads>().live(env); ++k)
      m.thread.push_back(cast<float>(state.template get<bead::Position>(env, k)));
    m.needle = {cast<float>(state.template get<needle::Position>(env, 0)),
                cast<float>(state.template get<needle::Orientation>(env, 0))};
    return m;
  }
};

// The tissue's skin, finer than the sheet: smooth curves through the sheet's vertices on each face of the
// block, and rounded edges. Everything but the displacements is worked out once.
class Skin {
 public:
  Skin(SuturingConfig const& c, int pieces) : rest_(surface_mesh(c).positions) {
    low_ = cast<float>(c.tissue.corner);
    high_ = cast<float>(c.tissue.corner + c.tissue.size);
    for (int a = 0; a < 3; ++a)
      cells_[a] = std::max(1, static_cast<int>(std::lround(c.tissue.size[a] / c.domain.cell_size)));
    number_vertices();
    // With almost no rounding, vertices are shared by the faces and lie where they would without.
    float const size = min(high_[0] - low_[0], min(high_[1] - low_[1], high_[2] - low_[2]));
    mesh_ = render::box_surface(low_, high_, pieces * cells_, 1e-5f * size);
    float const rounding = 0.04f * size;
    for (Vec3<float>& x : mesh_.positions) {
      stencils_.push_back(stencil_at(x));
      Vec3<float> inner;
      for (int a = 0; a < 3; ++a) inner[a] = clamp(x[a], low_[a] + rounding, high_[a] - rounding);
      x = inner + rounding * direction(x - inner);
    }
    mesh_.material = mesh_.positions;
  }

  // The skin when the sheet's vertices are at `now` [m].
  render::Mesh at(std::vector<Vec3<float>> const& now) const {
    render::Mesh mesh = mesh_;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      for (auto const& [vertex, weight] : stencils_[i])
        if (weight != 0.0f)
          mesh.positions[i] += weight * (now[vertex] - cast<float>(rest_[vertex]));
    render::compute_normals(mesh);
    return mesh;
  }

 private:
  struct Share {
    std::size_t vertex;
    float weight;
  };
  using Stencil = std::array<Share, 16>;

  std::size_t lattice_index(Vec3<int> const& i) const {
    return (static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(cells_[1] + 1) +
            static_cast<std::size_t>(i[1])) *
               static_cast<std::size_t>(cells_[0] + 1) +
           static_cast<std::size_t>(i[0]);
  }
  float lattice_place(int axis, float x) const {
    return (x - low_[axis]) / (high_[axis] - low_[axis]) * static_cast<float>(cells_[axis]);
  }
  void number_vertices() {
    number_.assign(lattice_index(cells_) + 1, 0);
    for (std::size_t v = 0; v < rest_.size(); ++v) {
      Vec3<int> i;
      for (int a = 0; a < 3; ++a)
        i[a] = static_cast<int>(std::lround(lattice_place(a, static_cast<float>(rest_[v][a]))));
      number_[lattice_index(i)] = v;
    }
  }
  // Catmull-Rom along both directions of the face on which x lies.
  Stencil stencil_at(Vec3<float> const& x) const {
    int face = 0;
    float nearest = 1e30f;
    for (int a = 0; a < 3; ++a) {
      float const away = min(abs(x[a] - low_[a]), abs(x[a] - high_[a]));
      if (away < nearest) {
        nearest = away;
        face = a;
      }
    }
    int const u = (face + 1) % 3, v = (face + 2) % 3;
    Vec3<int> cell{};
    cell[face] = x[face] > 0.5f * (low_[face] + high_[face]) ? cells_[face] : 0;
    auto const [iu, wu] = curve(u, x[u]);
    auto const [iv, wv] = curve(v, x[v]);
    Stencil s{};
    std::size_t n = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        cell[u] = clamp(iu + a - 1, 0, cells_[u]);
        cell[v] = clamp(iv + b - 1, 0, cells_[v]);
        s[n++] = {number_[lattice_index(cell)], wu[a] * wv[b]};
      }
    return s;
  }
  struct Curve {
    int first;
    Vec<float, 4> weight;
  };
  Curve curve(int axis, float x) const {
    float const place = clamp(lattice_place(axis, x), 0.0f, static_cast<float>(cells_[axis]));
    int const i = std::min(static_cast<int>(place), cells_[axis] - 1);
    float const t = place - static_cast<float>(i), t2 = t * t, t3 = t2 * t;
    return {i,
            {{0.5f * (-t + 2 * t2 - t3), 0.5f * (2 - 5 * t2 + 3 * t3), 0.5f * (t + 4 * t2 - 3 * t3),
              0.5f * (t3 - t2)}}};
  }

  std::vector<Vec3<double>> rest_;
  Vec3<float> low_{}, high_{};
  Vec3<int> cells_{};
  std::vector<std::size_t> number_{};  // of the sheet's vertex at each point of the lattice
  render::Mesh mesh_{};
  std::vector<Stencil> stencils_{};
};

// Draws moments. One of these may be used by many threads at once, each with a rasteriser of its own.
class StitchPicture {
 public:
  explicit StitchPicture(SuturingConfig const& c) : config_(c), skin_(c, 3) {
    low_ = cast<float>(c.tissue.corner);
    high_ = cast<float>(c.tissue.corner + c.tissue.size);
    eye_ = cast<float>(c.tissue.top() + c.camera.eye);
    target_ = cast<float>(c.tissue.top() + c.camera.target);
  }

  void draw(render::Rasteriser& with, Moment const& moment, int width, int height,
            render::Image& image) const {
    auto const skin = skin_.at(moment.surface);
    auto const needle = needle_mesh(moment.needle);
    auto const thread =
        render::thread_tube(moment.thread, static_cast<float>(1.4 * config_.thread.radius));
    auto const markers = ink();
    auto finish = render::tissue(high_[2] - low_[2]);
    finish.grid = static_cast<float>(config_.domain.cell_size);
    render::Object const objects[] = {
        {&skin, finish, markers}, {&needle, render::steel()}, {&thread, render::suture()}};
    auto const up = vec(0.0f, 0.0f, 1.0f);
    auto const field = static_cast<float>(config_.camera.field_of_view_deg * pi<double> / 180.0);
    auto const camera = render::look_at(eye_, target_, up, field, width, height);
    with.draw(camera, render::studio(low_, high_, eye_ - target_, up), objects, image);
  }

  render::Mesh skin(Moment const& moment) const { return skin_.at(moment.surface); }
  // From the blunt end to the tip.
  std::vector<Vec3<float>> needle_line(Pose<float> const& pose) const {
    auto const arc = config_.needle.arc();
    constexpr int pieces = 48;
    std::vector<Vec3<float>> line;
    for (int i = pieces; i >= 0; --i)
      line.push_back(to_world(pose, cast<float>(arc.point(arc.length() * i / pieces))));
    return line;
  }

 private:
  render::Mesh needle_mesh(Pose<float> const& pose) const {
    return render::needle_tube(needle_line(pose), static_cast<float>(config_.needle.wire_radius),
                               static_cast<float>(2 * config_.needle.taper));
  }
  std::vector<render::Marker> ink() const {
    auto const radius = static_cast<float>(0.5 * config_.markers.diameter);
    return {{cast<float>(config_.entry()), radius, vec(0.02f, 0.22f, 0.12f)},
            {cast<float>(config_.exit()), radius, vec(0.03f, 0.10f, 0.42f)}};
  }

  SuturingConfig config_;
  Skin skin_;
  Vec3<float> low_{}, high_{}, eye_{}, target_{};
};

}  // namespace mpmpbd::suturing
