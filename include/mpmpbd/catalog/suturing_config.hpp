// All numbers of the suturing scene: a block of tissue, an arc needle, the thread behind it, and the
// hand that drives one stitch. Read from examples/scenes/*.toml; shared by the stitch and the RL task.
//
// Coordinates: x from entry to exit, y along the needle's axis, z up; the block stands on its bottom,
// its lowest corner at tissue.corner_m. Marker places count from the middle of its top surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <mpmpbd/io/config_keys.hpp>
#include <mpmpbd/mpm/force_form.hpp>
#include <mpmpbd/mpm/materials/lame.hpp>
#include <mpmpbd/mpm/shape/bspline.hpp>
#include <mpmpbd/needle/arc_needle.hpp>
#include <mpmpbd/needle/suture_path.hpp>
#include <mpmpbd/pbd/rod_material.hpp>

namespace mpmpbd {

// How the tip of a needle presses into the surface before it goes through: force / (E dx^2) as a
// function of the dimple in cells, 0.8 d + 1.3 d^2. Measured in preset paper for d = 0.2...0.7 while the
// needle is driven; a point force at rest meets 3 d, because it sinks in only as far as the particles do.
inline constexpr double dimple_force(double cells) { return cells * (0.8 + 1.3 * cells); }

struct TissueConfig {
  double young_modulus = 500e3;
  double poisson_ratio = 0.4;
  double density = 1000.0;
  double viscosity = 500.0;
  Vec3<double> size{{2.0, 1.0, 1.0}};
  Vec3<double> corner{{0.5, 0.5, 0.3}};
  Vec<int, 3> points{{40, 20, 25}};

  Vec3<double> spacing() const {
    return {{size[0] / points[0], size[1] / points[1], size[2] / points[2]}};
  }
  double point_volume() const { return size[0] * size[1] * size[2] / point_count(); }  // [m^3]
  int point_count() const { return points[0] * points[1] * points[2]; }
  // The middle of the top surface [m].
  Vec3<double> top() const { return corner + vec(0.5 * size[0], 0.5 * size[1], size[2]); }
  Lame<double> lame() const { return mpmpbd::lame(young_modulus, poisson_ratio); }
  // Material points [m], (point), x fastest.
  std::vector<Vec3<double>> positions() const {
    std::vector<Vec3<double>> all;
    all.reserve(static_cast<std::size_t>(point_count()));
    auto const d = spacing();
    for (int k = 0; k < points[2]; ++k)
      for (int j = 0; j < points[1]; ++j)
        for (int i = 0; i < points[0]; ++i)
          all.push_back(corner + vec((i + 0.5) * d[0], (j + 0.5) * d[1], (k + 0.5) * d[2]));
    return all;
  }

  void declare(ConfigKeys& keys) {
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"), "Young's modulus");
    keys(poisson_ratio, {"poisson_ratio", "1", 0.0, 0.5, true, false}, "Poisson's ratio");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density at rest");
    keys(viscosity, bound::not_negative("viscosity_pa_s", "Pa s"), "viscosity, lets waves die out");
    keys(size, bound::positive("size_m", "m"), "size of the block");
    keys(corner, bound::not_negative("corner_m", "m"), "its lowest corner in the domain");
    keys(points, bound::between("points", "1", 1, 4096), "material points along each edge");
  }
  bool operator==(TissueConfig const&) const = default;
};

struct DomainConfig {
  Vec3<double> size{{3.0, 2.0, 1.8}};
  double cell_size = 0.1;
  Vec3<double> gravity{{0.0, 0.0, -9.81}};

  Vec<int, 3> nodes() const {
    Vec<int, 3> n{};
    for (int a = 0; a < 3; ++a) n[a] = static_cast<int>(std::lround(size[a] / cell_size)) + 1;
    return n;
  }

  void declare(ConfigKeys& keys) {
    keys(size, bound::positive("size_m", "m"), "size of the grid's domain, whole cells");
    keys(cell_size, bound::positive("cell_size_m", "m"), "size of a grid cell");
    keys(gravity, bound::any("gravity_m_s2", "m/s^2"), "gravity");
  }
  bool operator==(DomainConfig const&) const = default;
};

struct TimeConfig {
  double step = 0.004;
  int substeps = 4;
  bool strict = true;

  void declare(ConfigKeys& keys) {
    keys(step, bound::positive("step_s", "s"), "one step of the scene");
    keys(substeps, bound::between("substeps", "1", 0, 1000000),
         "substeps of a step, 0: chosen in each step from the stable limit");
    keys(strict, "strict", "refuse a substep longer than the stable limit of the tissue at rest");
  }
  bool operator==(TimeConfig const&) const = default;
};

struct NeedleConfig {
  double radius = 0.32;
  double angle_deg = 180.0;
  double wire_radius = 0.02;
  double taper = 0.06;
  double puncture_force = 6250.0;
  double cutting_force = 2080.0;

  double angle() const { return angle_deg * pi<double> / 180.0; }  // [rad]
  Arc<double> arc() const { return {radius, angle(), wire_radius, taper}; }
  ArcNeedle::Parameters<double> parameters() const {
    return {radius, angle(), wire_radius, taper, puncture_force, cutting_force};
  }

  void declare(ConfigKeys& keys) {
    keys(radius, bound::positive("radius_m", "m"), "radius of the arc");
    keys(angle_deg, {"angle_deg", "deg", 0.0, 360.0, false, true}, "from the tip to the blunt end");
    keys(wire_radius, bound::positive("wire_radius_m", "m"), "radius of the wire");
    keys(taper, bound::not_negative("taper_m", "m"), "length of the pointed part");
    keys(puncture_force, bound::positive("puncture_force_n", "N"),
         "force on the tip at which it goes through the surface");
    keys(cutting_force, bound::not_negative("cutting_force_n", "N"),
         "force on the tip that cuts its way in tissue");
  }
  bool operator==(NeedleConfig const&) const = default;
};

struct ThreadConfig {
  double length = 1.6;
  int beads = 20;
  double radius = 0.00575;
  double young_modulus = 33e9;
  double density = 1140.0;
  double bending_share = 0.003;
  double air = 5.0;

  RodMaterial material() const { return {young_modulus, radius, density, bending_share}; }
  double segment() const { return length / (beads - 1); }  // [m]

  void declare(ConfigKeys& keys) {
    keys(length, bound::positive("length_m", "m"), "length");
    keys(beads, bound::between("beads", "1", 3, 100000), "points that it is made of");
    keys(radius, bound::positive("radius_m", "m"), "radius");
    keys(young_modulus, bound::positive("young_modulus_pa", "Pa"),
         "Young's modulus, for stretch and bending");
    keys(density, bound::positive("density_kg_m3", "kg/m^3"), "density");
    keys(bending_share, {"bending_share", "1", 0.0, 1.0, false, true},
         "of the bending stiffness of a solid wire; about 1 over the filaments of a braid");
    keys(air, bound::not_negative("air_per_s", "1/s"),
         "rate at which the free thread loses its speed");
  }
  bool operator==(ThreadConfig const&) const = default;
};

struct ContactConfig {
  double friction = 0.2;
  double clamp_pressure = 33e3;
  double drag = 833.0;

  void declare(ConfigKeys& keys) {
    keys(friction, bound::between("friction_coefficient", "1", 0.0, 10.0), "Coulomb friction");
    keys(clamp_pressure, bound::not_negative("clamp_pressure_pa", "Pa"),
         "pressure with which an unloaded channel grips");
    keys(drag, bound::not_negative("drag_n_s_m2", "N s/m^2"),
         "viscous force per length and sliding speed");
  }
  bool operator==(ContactConfig const&) const = default;
};

struct MarkerConfig {
  Vec3<double> entry{{-0.30, 0.0, 0.0}};
  Vec3<double> exit{{0.30, 0.0, 0.0}};
  double diameter = 0.075;

  void declare(ConfigKeys& keys) {
    keys(entry, bound::any("entry_m", "m"),
         "where the tip is to go in, from the middle of the top");
    keys(exit, bound::any("exit_m", "m"), "where it is to come out, from the middle of the top");
    keys(diameter, bound::positive("diameter_m", "m"), "diameter of a marker");
  }
  bool operator==(MarkerConfig const&) const = default;
};

struct MotionConfig {
  double drive_time = 6.0;
  double pull_time = 4.0;
  double approach_deg = 20.0;
  double out_deg = 30.0;
  double clear_deg = 10.0;
  Vec3<double> pull{{0.15, 0.0, 0.30}};

  SutureMotion motion() const {
    constexpr double degree = pi<double> / 180.0;
    SutureMotion how;
    how.approach = approach_deg * degree;
    how.out = out_deg * degree;
    how.clear = clear_deg * degree;
    how.drive_time = drive_time;
    how.pull_time = pull_time;
    how.pull = pull;
    return how;
  }

  void declare(ConfigKeys& keys) {
    keys(drive_time, bound::positive("drive_time_s", "s"), "driving the needle round");
    keys(pull_time, bound::positive("pull_time_s", "s"), "turning it out and pulling the thread");
    keys(approach_deg, bound::between("approach_deg", "deg", 0.0, 360.0),
         "how far before the entry marker the tip starts");
    keys(out_deg, bound::between("out_deg", "deg", 0.0, 360.0),
         "how far the tip is out of the exit marker when driving ends");
    keys(clear_deg, bound::between("clear_deg", "deg", 0.0, 360.0),
         "how far the blunt end is out when the needle is free");
    keys(pull, bound::any("pull_m", "m"), "shift of the free needle, which pulls the thread");
  }
  bool operator==(MotionConfig const&) const = default;
};

struct CameraConfig {
  Vec3<double> eye{{0.4, -3.0, 1.9}};
  Vec3<double> target{{0.0, 0.0, -0.2}};
  double field_of_view_deg = 38.0;

  void declare(ConfigKeys& keys) {
    keys(eye, bound::any("eye_m", "m"), "where it stands, from the middle of the top");
    keys(target, bound::any("target_m", "m"), "what it looks at, from the middle of the top");
    keys(field_of_view_deg, {"field_of_view_deg", "deg", 0.0, 180.0, false, false},
         "height of the picture as an angle");
  }
  bool operator==(CameraConfig const&) const = default;
};

struct OutputConfig {
  double frames_per_second = 25.0;
  int width = 1280;
  int height = 720;
  int small_width = 250;
  int small_height = 250;
  double snapshot_interval = 1.0;

  void declare(ConfigKeys& keys) {
    keys(frames_per_second, bound::positive("frames_per_second", "1/s"),
         "frames of the video per second of simulated time");
    keys(width, bound::between("width", "1", 16, 8192), "width of the video, in pixels");
    keys(height, bound::between("height", "1", 16, 8192), "height of the video, in pixels");
    keys(small_width, bound::between("small_width", "1", 16, 8192), "width of the small video");
    keys(small_height, bound::between("small_height", "1", 16, 8192), "height of the small video");
    keys(snapshot_interval, bound::positive("snapshot_interval_s", "s"),
         "simulated time between two VTK or PLY files");
  }
  bool operator==(OutputConfig const&) const = default;
};

struct SuturingConfig {
  std::int64_t seed = 1;
  TissueConfig tissue;
  DomainConfig domain;
  TimeConfig time;
  NeedleConfig needle;
  ThreadConfig thread;
  ContactConfig contact;
  MarkerConfig markers;
  MotionConfig motion;
  CameraConfig camera;
  OutputConfig output;

  Vec3<double> entry() const { return tissue.top() + markers.entry; }  // [m] in the domain
  Vec3<double> exit() const { return tissue.top() + markers.exit; }
  // The circle of the needle through both markers. Throws when the needle is too small for them.
  SuturePath path() const {
    return SuturePath::between(entry(), exit(), vec(0.0, 0.0, 1.0), needle.radius);
  }
  Script script() const { return suture_script(path(), needle.arc(), motion.motion()); }
  double duration() const { return motion.drive_time + motion.pull_time; }  // [s]
  int steps() const { return static_cast<int>(std::lround(duration() / time.step)); }
  // Substeps of a step that the stable limit of tissue at rest leaves, at least.
  int least_substeps() const { return substeps_of(stable_dt()); }
  // Why the hand cannot sew like this, in the words of who makes its script; empty: it can.
  std::string no_script() const {
    try {
      script();
      return {};
    } catch (std::invalid_argument const& reason) { return reason.what(); }
  }
  // The longest stable substep [s] of the tissue at rest: MLS forces, quadratic splines, with
  // omega^2 = D^-1 max(3 K, M) / rho, shortened by viscosity (effects/viscosity.hpp).
  double stable_dt() const {
    auto const k = tissue.lame();
    double const stiffness = k.lambda + 2 * k.mu + 2 * std::max(k.lambda, 0.0);
    double const inverse_inertia =
        QuadraticBSpline::inverse_inertia / (domain.cell_size * domain.cell_size);
    double const omega = std::sqrt(inverse_inertia * stiffness / tissue.density);
    double const xi = inverse_inertia * tissue.viscosity / (tissue.density * omega);
    return 2.0 / omega * (std::sqrt(1.0 + xi * xi) - xi);
  }
  // How deep a tip sinks in before it goes through [m], estimated.
  double dimple() const {
    double const dx = domain.cell_size;
    double const force = needle.puncture_force / (tissue.young_modulus * dx * dx);
    return dx * (std::sqrt(0.64 + 5.2 * force) - 0.8) / 2.6;  // dimple_force(dimple / dx) = force
  }

  void declare(ConfigKeys& keys) {
    keys(seed, bound::between("seed", "1", 0, 9e15), "seed of all random numbers");
    keys.table(tissue, "tissue", "Soft tissue: a neo-Hookean block, its bottom fixed.");
    keys.table(domain, "domain", "The grid and gravity.");
    keys.table(time, "time", "Time steps.");
    keys.table(needle, "needle", "The needle: an arc of wire.");
    keys.table(thread, "thread", "The thread, tied to the needle's blunt end.");
    keys.table(contact, "contact", "Needle and thread in tissue.");
    keys.table(markers, "markers", "Entry and exit on the top surface.");
    keys.table(motion, "motion", "The scripted hand.");
    keys.table(camera, "camera", "The camera.");
    keys.table(output, "output", "Pictures and files.");
  }

  void check(ConfigRules& rules) const {
    check_domain(rules);
    check_time(rules);
    check_needle_and_markers(rules);
    check_thread(rules);
    // Rounding may see an angle beyond its bound there that is just within it here.
    if (rules.all_hold()) {
      auto const reason = no_script();
      rules.require("motion.approach_deg", reason.empty(), reason);
    }
  }
  bool operator==(SuturingConfig const&) const = default;

 private:
  // Substeps of a step that are no longer than this [s]; 1e9 stands for all that no run could take.
  int substeps_of(double longest) const {
    double const needed = std::ceil(time.step / longest - 1e-9);
    return needed < 1e9 ? std::max(1, static_cast<int>(needed)) : 1000000000;
  }
  // Half the distance between the markers, as their path has it [m].
  double half_distance() const { return 0.5 * norm(exit() - entry()); }
  // Whether a path leads from marker to marker: the rules say why there is none.
  bool has_path() const {
    double const half = half_distance();
    return half > 0.0 && half <= needle.radius && markers.entry[0] != markers.exit[0] &&
           markers.entry[2] == 0.0 && markers.exit[2] == 0.0;
  }

  void check_domain(ConfigRules& rules) const {
    double const dx = domain.cell_size;
    char const* const axes = "xyz";
    for (int a = 0; a < 3; ++a) {
      double const cells = domain.size[a] / dx;
      rules.require("domain.size_m", std::abs(cells - std::round(cells)) < 1e-6 * cells,
                    fmt::format("give a whole number of cells of {} m along {}", dx, axes[a]));
      rules.number(
          "tissue.size_m", tissue.size[a], {dx, domain.size[a] - 4 * dx},
          fmt::format(
              "along {} the tissue is at least a cell thick and has two free cells on each side",
              axes[a]));
      rules.number("tissue.corner_m", tissue.corner[a],
                   {2 * dx, std::max(2 * dx, domain.size[a] - tissue.size[a] - 2 * dx)},
                   fmt::format("along {} two cells stay free on each side of the tissue", axes[a]));
      rules.number(
          "tissue.points", tissue.points[a], {std::ceil(tissue.size[a] / dx - 1e-9)},
          fmt::format("along {} there is at least one point per cell, or the tissue has holes",
                      axes[a]));
    }
    rules.require("domain.size_m",
                  domain.size[0] / dx * (domain.size[1] / dx) * (domain.size[2] / dx) < 5e8,
                  "the grid has more than 5e8 cells; give larger cells");
    rules.require("tissue.points",
                  double(tissue.points[0]) * tissue.points[1] * tissue.points[2] < 5e8,
                  "give less than 5e8 of them");
  }

  void check_time(ConfigRules& rules) const {
    rules.number("time.step_s", time.step, {duration() / 1e9, duration()},
                 "a stitch takes one step at least, and less than 1e9");
    if (!time.strict || time.substeps == 0) return;
    double const limit = stable_dt();
    int const calm = substeps_of(0.8 * limit);
    rules.number(
        "time.substeps", time.substeps, {static_cast<double>(least_substeps())},
        fmt::format(
            "a substep may last {:.3g} s here (give {} to stay 20 % below, 0 to have them chosen, or strict = false)",
            limit, calm));
  }

  void check_needle_and_markers(ConfigRules& rules) const {
    double const dx = domain.cell_size;
    double const smallest = std::min({domain.size[0], domain.size[1], domain.size[2]});
    double const half = half_distance();
    rules.number("needle.radius_m", needle.radius, {0.0, smallest / 2},
                 "the needle is not larger than the domain");
    rules.number("needle.wire_radius_m", needle.wire_radius, {0.0, needle.radius / 2},
                 "the wire is thinner than half of the arc's radius");
    rules.number("needle.taper_m", needle.taper, {0.0, needle.radius * needle.angle()},
                 "the point is not longer than the needle");
    rules.number("needle.cutting_force_n", needle.cutting_force, {0.0, needle.puncture_force},
                 "cutting takes less force than puncture");
    rules.number("needle.puncture_force_n", needle.puncture_force,
                 {0.0, dimple_force(1.0) * tissue.young_modulus * dx * dx},
                 "with more, the tip sinks in by more than a cell before it goes through");
    check_marker(rules, "markers.entry_m", markers.entry);
    check_marker(rules, "markers.exit_m", markers.exit);
    rules.require("markers.exit_m", half > 0.5 * markers.diameter,
                  "entry and exit overlap; give markers at least a diameter apart");
    rules.require(
        "markers.exit_m", half <= needle.radius,
        fmt::format(
            "the markers are {:.4g} m apart, too far for a needle of radius {} m; give at most {:.4g} m",
            2 * half, needle.radius, 2 * needle.radius));
    if (!has_path()) return;
    auto const p = path();
    double const deep = p.depth + needle.wire_radius;
    rules.require(
        "needle.radius_m", deep <= tissue.size[2] - dx,
        fmt::format(
            "the needle would go {:.4g} m deep, the tissue is {} m deep; give another radius or other markers",
            deep, tissue.size[2]));
    check_motion(rules, p);
  }

  void check_marker(ConfigRules& rules, char const* key, Vec3<double> const& at) const {
    for (int a = 0; a < 2; ++a) {
      double const room = 0.5 * (tissue.size[a] - markers.diameter);
      rules.number(key, at[a], {-room, room}, "the marker lies on the tissue");
    }
    rules.number(key, at[2], {0.0, 0.0}, "markers are on the top surface, z = 0");
  }

  void check_motion(ConfigRules& rules, SuturePath const& p) const {
    constexpr double degree = pi<double> / 180.0;
    double const in_tissue = p.angle / degree;
    double const room = 360.0 - in_tissue - needle.angle_deg;
    rules.number("needle.angle_deg", needle.angle_deg, {in_tissue, 360.0 - in_tissue},
                 "the tip is out before the blunt end goes in, and there is room to start");
    rules.number("motion.approach_deg", motion.approach_deg, {0.0, std::max(room, 0.0)},
                 "neither end of the needle is in tissue at the start");
    rules.number("motion.clear_deg", motion.clear_deg, {0.0, std::max(room, 0.0)},
                 "neither end of the needle is in tissue at the end");
    rules.number("motion.out_deg", motion.out_deg,
                 {0.0, std::max(needle.angle_deg - in_tissue, 0.0)},
                 "the blunt end is not yet in tissue when driving ends");
  }

  void check_thread(ConfigRules& rules) const {
    rules.number("thread.beads", thread.beads,
                 {std::ceil(thread.length / domain.cell_size - 1e-9) + 1},
                 "a segment of the thread is not longer than a cell");
    rules.number("thread.radius_m", thread.radius, {0.0, thread.segment() / 2},
                 "a segment of the thread is longer than it is thick");
    if (!has_path()) return;
    double const used = path().angle * needle.radius +
                        motion.clear_deg * pi<double> / 180.0 * needle.radius + norm(motion.pull);
    rules.number("thread.length_m", thread.length, {used},
                 "so much lies in tissue and behind the needle when the pull ends");
  }
};

}  // namespace mpmpbd
