// What the camera sees of a suturing scene: taken from a simulation as a few numbers, drawn later.
#pragma once

#include <array>
#include <vector>

#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/render/rasteriser.hpp>
#include <mpmpbd/render/tube.hpp>

namespace mpmpbd::suturing {

namespace detail {
// One environment of a simulation that is only looked at.
template <class Sim> struct ReadOnly {
  Sim const& sim;
  std::int64_t env;
  template <class Domain> std::int64_t live() const {
    return sim.state().template table<Domain>().live(env);
  }
  template <class F> auto get(std::int64_t slot) const {
    return sim.state().template get<F>(env, slot);
  }
};
}  // namespace detail

// A moment of one environment: enough to draw it, small enough to keep all of a video.
struct Moment {
  double time = 0.0;                   // [s]
  std::vector<Vec3<float>> surface{};  // vertices of the tissue's sheet [m]
  std::vector<Vec3<float>> thread{};   // beads [m]
  Pose<float> needle{};

  // Takes what it is of one environment (pbd/access.hpp); its memory is used again.
  template <class Env> void take(Env const& env) {
    surface.clear();
    thread.clear();
    for (std::int64_t i = 0; i < env.template live<SheetVertices>(); ++i)
      surface.push_back(cast<float>(env.template get<sheet::Position>(i)));
    for (std::int64_t k = 0; k < env.template live<Beads>(); ++k)
      thread.push_back(cast<float>(env.template get<bead::Position>(k)));
    needle = {cast<float>(env.template get<needle::Position>(0)),
              cast<float>(env.template get<needle::Orientation>(0))};
  }
  template <class Sim> static Moment of(Sim const& sim, std::int64_t env, double time) {
    Moment m;
    m.time = time;
    m.take(detail::ReadOnly<Sim>{sim, env});
    return m;
  }
};

// Everything else that a picture depends on and that may differ between environments.
struct Look {
  Vec3<float> eye{}, target{};               // [m]
  Vec3<float> tint = vec(1.0f, 1.0f, 1.0f);  // factors on the tissue's colour, linear RGB
  Arc<float> needle{};
  std::array<Vec3<float>, 2> markers{};  // entry and exit, at rest [m]
};

// The tissue's skin, finer than the sheet: smooth curves through the sheet's vertices on each face
// of the block, and rounded edges. Everything but the displacements is worked out once.
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
  void at(std::span<Vec3<float> const> now, render::Mesh& mesh) const {
    mesh = mesh_;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      for (auto const& [vertex, weight] : stencils_[i])
        if (weight != 0.0f)
          mesh.positions[i] += weight * (now[vertex] - cast<float>(rest_[vertex]));
    render::compute_normals(mesh);
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

// What one thread draws with; its memory is used again.
struct Canvas {
  render::Rasteriser rasteriser{};
  render::Mesh skin{};
  render::TubeMaker thread{}, needle{};
  std::vector<Vec3<float>> wire{};
};

// Draws moments. One of these may be used by many threads at once, each with a canvas of its own.
class StitchPicture {
 public:
  explicit StitchPicture(SuturingConfig const& c) : config_(c), skin_(c, 3) {
    low_ = cast<float>(c.tissue.corner);
    high_ = cast<float>(c.tissue.corner + c.tissue.size);
    look_ = {.eye = cast<float>(c.tissue.top() + c.camera.eye),
             .target = cast<float>(c.tissue.top() + c.camera.target),
             .needle = single(c.needle.arc()),
             .markers = {cast<float>(c.entry()), cast<float>(c.exit())}};
  }

  // How the scene looks that the configuration describes.
  Look const& look() const { return look_; }

  void draw(Canvas& with, Moment const& moment, Look const& look, int width, int height,
            render::Image& image) const {
    skin_.at(moment.surface, with.skin);
    needle_line(moment.needle, look.needle, with.wire);
    auto const& needle =
        with.needle.needle(with.wire, static_cast<float>(config_.needle.wire_radius),
                           static_cast<float>(2 * config_.needle.taper));
    auto const& thread =
        with.thread.thread(moment.thread, static_cast<float>(1.4 * config_.thread.radius));
    auto const radius = static_cast<float>(0.5 * config_.markers.diameter);
    render::Marker const ink[] = {{look.markers[0], radius, vec(0.02f, 0.22f, 0.12f)},
                                  {look.markers[1], radius, vec(0.03f, 0.10f, 0.42f)}};
    auto finish = render::tissue(high_[2] - low_[2]);
    finish.grid = static_cast<float>(config_.domain.cell_size);
    for (int k = 0; k < 3; ++k) finish.colour[k] = min(look.tint[k] * finish.colour[k], 1.0f);
    render::Object const objects[] = {
        {&with.skin, finish, ink}, {&needle, render::steel()}, {&thread, render::suture()}};
    auto const up = vec(0.0f, 0.0f, 1.0f);
    auto const field = static_cast<float>(config_.camera.field_of_view_deg * pi<double> / 180.0);
    auto const camera = render::look_at(look.eye, look.target, up, field, width, height);
    with.rasteriser.draw(camera, render::studio(low_, high_, look.eye - look.target, up), objects,
                         image);
  }
  void draw(Canvas& with, Moment const& moment, int width, int height, render::Image& image) const {
    draw(with, moment, look_, width, height, image);
  }

  render::Mesh skin(Moment const& moment) const {
    render::Mesh mesh;
    skin_.at(moment.surface, mesh);
    return mesh;
  }
  // From the blunt end to the tip.
  std::vector<Vec3<float>> needle_line(Pose<float> const& pose) const {
    std::vector<Vec3<float>> line;
    needle_line(pose, look_.needle, line);
    return line;
  }

 private:
  static Arc<float> single(Arc<double> const& arc) {
    return {static_cast<float>(arc.radius), static_cast<float>(arc.angle),
            static_cast<float>(arc.wire_radius), static_cast<float>(arc.taper)};
  }
  static void needle_line(Pose<float> const& pose, Arc<float> const& arc,
                          std::vector<Vec3<float>>& line) {
    constexpr int pieces = 48;
    line.clear();
    for (int i = pieces; i >= 0; --i)
      line.push_back(to_world(pose, arc.point(arc.length() * static_cast<float>(i) / pieces)));
  }

  SuturingConfig config_;
  Skin skin_;
  Vec3<float> low_{}, high_{};
  Look look_{};
};

}  // namespace mpmpbd::suturing
