// What a stitch is judged by: forces and events while it runs, the thread's way through tissue at its end.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include <mpmpbd/catalog/suturing.hpp>

namespace mpmpbd::suturing {

// One step of the run.
struct StitchSample {
  double time;                 // at its end [s]
  double depth;                // how far the tip has come past the entry marker, along the arc [m]
  Vec3<double> force, moment;  // tissue on needle, mean over the step [N, N m]
  double peak_force;           // largest of its substeps [N]
  double tip_force;            // axial [N]
  double dimple;  // how deep the tip presses the surface in, before it goes through [m]
  double pull;    // of the thread on the needle [N]
  double most_tension, least_tension;  // of the segments in tissue [N]
  int embedded;                        // segments in tissue
  TipState tip;
  std::uint32_t status;
  int substeps;
};

// Where the thread goes through the surface.
struct ThreadCrossing {
  Vec3<double> at;  // [m]
  bool inwards;     // on the way from the thread's free end to the needle
  double to_track;  // from the needle's track [m]; infinite without one
};

struct Verdict {
  std::string name;
  bool holds;
  std::string finding;
};

inline std::string faults_in_words(std::uint32_t status) {
  std::string words;
  for (auto const& f : fault_table)
    if (has(status, f.fault)) words += fmt::format("{}{}", words.empty() ? "" : "; ", f.meaning);
  return words.empty() ? "no fault" : words;
}

// Largest memory that the program has held so far [byte].
inline double peak_memory() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1024.0 * static_cast<double>(use.ru_maxrss);
}

namespace detail {

struct AllTriangles {
  std::int64_t count;
  template <class T, class F>
  void for_each(Solo const&, Vec3<T> const&, Vec3<T> const&, F&& f) const {
    for (std::int64_t k = 0; k < count; ++k) f(k);
  }
};

// The tissue's surface as it is now, in double.
template <class Sim> SheetMesh<double> surface_now(Sim const& sim, std::int64_t env) {
  SheetMesh<double> mesh;
  auto const& vertices = sim.state().template table<SheetVertices>();
  auto const& triangles = sim.state().template table<SheetTriangles>();
  for (std::int64_t i = 0; i < vertices.capacity(); ++i)
    mesh.positions.push_back(cast<double>(sim.state().template get<sheet::Position>(env, i)));
  for (std::int64_t k = 0; k < triangles.capacity(); ++k)
    mesh.triangles.push_back(sim.state().template get<sheet::Corners>(env, k));
  return mesh;
}

// A bead is in tissue with both its sides, a segment with both its beads.
template <class Sim> bool is_inside(Sim const& sim, std::int64_t env, std::int64_t bead) {
  return sim.state().template get<channel::Member<ContactPoints>>(env, bead) ==
         side_before + side_after;
}
template <class Sim> bool is_embedded(Sim const& sim, std::int64_t env, std::int64_t segment) {
  return is_inside(sim, env, segment) && is_inside(sim, env, segment + 1);
}

template <class Sim> double distance_to_tracks(Sim& sim, std::int64_t env, Vec3<double> const& x) {
  using T = typename Sim::Scalar;
  auto const set = channel_set(sim.state().template view<Channels>(),
                               sim.state().template view<ChannelPoints>(), env);
  double nearest = bound::none;
  for (std::int64_t c = 0; c < set.capacity(); ++c)
    if (set.in_use(c) && set.track_points(c) > 0)
      nearest = std::min(nearest, static_cast<double>(set.distance_to_track(c, cast<T>(x))));
  return nearest;
}

}  // namespace detail

// A thread that lies on the surface dips into it by rounding. It has gone in when it is as deep as a tip has
// to come up to count as out; the place is where it met the surface on the way there.
template <class Sim>
std::vector<ThreadCrossing> thread_crossings(Sim& sim, std::int64_t env, double dx) {
  auto const mesh = detail::surface_now(sim, env);
  auto const sheet = sheet_of(mesh);
  detail::AllTriangles const all{static_cast<std::int64_t>(mesh.triangles.size())};
  double const margin = TipLimits::clearance * dx;
  std::vector<ThreadCrossing> found;
  bool inside = false, first = true;
  Vec3<double> passed{};  // where it last went through the sheet
  double before = 0.0;
  std::int64_t const beads = sim.state().template table<Beads>().live(env);
  constexpr int pieces = 16;
  for (std::int64_t k = 0; k + 1 < beads; ++k) {
    auto const a = cast<double>(sim.state().template get<bead::Position>(env, k));
    auto const b = cast<double>(sim.state().template get<bead::Position>(env, k + 1));
    for (int i = 0; i <= pieces; ++i) {
      auto const x = a + (static_cast<double>(i) / pieces) * (b - a);
      auto const surface = nearest_on_sheet(sheet, all, x, 4 * dx);
      if ((surface.distance < 0.0) != (before < 0.0) || first) passed = surface.point;
      before = surface.distance;
      if (first) inside = surface.distance < 0.0;
      first = false;
      bool const now = inside ? surface.distance <= margin : surface.distance < -margin;
      if (now != inside)
        found.push_back({passed, now, detail::distance_to_tracks(sim, env, passed)});
      inside = now;
    }
  }
  return found;
}

class StitchReport {
 public:
  explicit StitchReport(SuturingConfig const& c) : config_(c), path_(c.path()) {
    angle_ = -c.motion.approach_deg * pi<double> / 180.0;
  }

  std::vector<StitchSample> const& samples() const { return samples_; }
  StitchSample const& last() const { return samples_.back(); }

  template <class Sim> void record(Sim const& sim, std::int64_t env, double time) {
    auto const& state = sim.state();
    StitchSample s{};
    s.time = time;
    s.depth = follow(Pose<double>{cast<double>(state.template get<needle::Position>(env, 0)),
                                  cast<double>(state.template get<needle::Orientation>(env, 0))});
    s.force = cast<double>(state.template get<needle::Force>(env, 0));
    s.moment = cast<double>(state.template get<needle::Moment>(env, 0));
    s.peak_force = static_cast<double>(state.template get<needle::PeakForce>(env, 0));
    s.tip_force = static_cast<double>(state.template get<needle::TipForce>(env, 0));
    s.pull = static_cast<double>(state.template get<needle::ThreadPull>(env, 0));
    s.tip = static_cast<TipState>(state.template get<tip::State>(env, 0));
    s.status = sim.status(env);
    s.substeps = static_cast<int>(state.template get<environment::Substeps>(env));
    if (s.tip == TipState::touch)
      s.dimple = static_cast<double>(dot(
          state.template get<tip::TouchPoint>(env, 0) - state.template get<tip::Position>(env, 0),
          state.template get<tip::TouchNormal>(env, 0)));
    for (std::int64_t k = 0; k + 1 < config_.thread.beads; ++k) {
      if (!detail::is_embedded(sim, env, k)) continue;
      double const tension = static_cast<double>(state.template get<bead::Tension>(env, k));
      s.least_tension = s.embedded == 0 ? tension : std::min(s.least_tension, tension);
      s.most_tension = s.embedded == 0 ? tension : std::max(s.most_tension, tension);
      ++s.embedded;
    }
    samples_.push_back(s);
  }

  // What can only be seen when it is over.
  template <class Sim> void finish(Sim& sim, std::int64_t env) {
    auto const view = sim.state().template view<Events>();
    auto const environments = sim.state().template view<Environments>();
    auto const log = event_log(view, environments, env);
    for (std::int64_t i = 0; i < log.count(); ++i) events_.push_back(log(i));
    crossings_ = thread_crossings(sim, env, config_.domain.cell_size);
    memory_ = peak_memory();
  }

  using Event = SurfaceEvent<float>;
  // The first event of a kind, or null. An exit counts after an entry.
  Event const* event(EventKind kind) const {
    bool entered = false;
    for (auto const& e : events_) {
      if (e.kind == kind && (kind == EventKind::entry || entered)) return &e;
      entered = entered || e.kind == EventKind::entry;
    }
    return nullptr;
  }
  std::vector<ThreadCrossing> const& crossings() const { return crossings_; }

  double peak_force() const {
    double peak = 0.0;
    for (auto const& s : samples_) peak = std::max(peak, s.peak_force);
    return peak;
  }
  // Mean over the steps in which tissue acts on the needle.
  double mean_force() const {
    double sum = 0.0;
    int count = 0;
    for (auto const& s : samples_)
      if (norm(s.force) > 0.0) {
        sum += norm(s.force);
        ++count;
      }
    return count > 0 ? sum / count : 0.0;
  }
  double peak_tension() const {
    double peak = 0.0;
    for (auto const& s : samples_) peak = std::max(peak, std::max(s.pull, s.most_tension));
    return peak;
  }

  // Every demand on a stitch, with what was found.
  std::vector<Verdict> verdicts() const {
    std::vector<Verdict> all;
    auto say = [&all](std::string name, bool holds, std::string finding) {
      all.push_back({std::move(name), holds, std::move(finding)});
    };
    double const dx = config_.domain.cell_size, reach = config_.markers.diameter;
    judge_events(say, reach);
    judge_puncture(say, dx);
    judge_forces(say);
    judge_thread(say, dx);
    say("no fault", last().status == 0, faults_in_words(last().status));
    say("memory below 2 GiB", memory_ < 2.0 * 1024 * 1024 * 1024,
        fmt::format("{:.0f} MiB", memory_ / 1048576.0));
    return all;
  }

 private:
  // The tip's way past the entry marker; counts on when the needle has gone round.
  double follow(Pose<double> const& pose) {
    auto const rest = path_.pose(0.0);
    auto const x = quaternion::rotate(pose.orientation, vec(1.0, 0.0, 0.0));
    auto const x0 = quaternion::rotate(rest.orientation, vec(1.0, 0.0, 0.0));
    double const turn = 2.0 * pi<double>;
    double const now = std::atan2(dot(path_.axis, cross(x0, x)), dot(x0, x));
    angle_ += std::remainder(now - angle_, turn);
    return angle_ * path_.radius;
  }

  template <class Say> void judge_events(Say& say, double reach) const {
    for (auto kind : {EventKind::entry, EventKind::exit}) {
      auto const* e = event(kind);
      char const* const name = kind == EventKind::entry ? "entry" : "exit";
      say(fmt::format("{} hits its marker", name),
          e != nullptr && static_cast<double>(e->miss) < reach,
          e == nullptr ? std::string("never happened")
                       : fmt::format("missed by {:.4g} m, {:.4g} m allowed, at {:.3f} s", e->miss,
                                     reach, e->time));
    }
  }

  template <class Say> void judge_puncture(Say& say, double dx) const {
    auto const* entry = event(EventKind::entry);
    double early = 0.0, dimple = 0.0, highest = 0.0, lowest = bound::none;
    bool touched = false;
    for (auto const& s : samples_) {
      touched = touched || s.tip != TipState::outside;
      if (!touched) early = std::max(early, s.peak_force);
      dimple = std::max(dimple, s.dimple);
      if (entry == nullptr) continue;
      double const since = s.time - static_cast<double>(entry->time);
      if (since <= 2 * config_.time.step) highest = std::max(highest, norm(s.force));
      if (since > 0.0 && since < 0.2) lowest = std::min(lowest, norm(s.force));
    }
    say("no tissue force before touch", touched && early == 0.0,
        touched ? fmt::format("{:.3g} N", early) : std::string("never touched"));
    // Half of what the tip's own law gives up when it goes through.
    double const drop = 0.5 * (config_.needle.puncture_force - config_.needle.cutting_force);
    bool const punctured = entry != nullptr && highest - lowest > drop;
    say("puncture shows as a force drop", punctured,
        entry == nullptr ? std::string("no puncture")
                         : fmt::format("from {:.4g} N to {:.4g} N within 0.2 s", highest, lowest));
    say("dimple at puncture at most a cell", entry != nullptr && dimple > 0.0 && dimple <= dx,
        fmt::format("{:.4g} m, a cell is {:.4g} m", dimple, dx));
  }

  // The bench's band, 0.15 N to 3 N, in units of the puncture force.
  template <class Say> void judge_forces(Say& say) const {
    double const low = config_.needle.puncture_force * (1.0 - TipLimits::tolerance),
                 high = 20.0 * config_.needle.puncture_force;
    say("peak needle force between puncture and 20 times as much",
        peak_force() >= low && peak_force() <= high,
        fmt::format("{:.4g} N in [{:.4g}, {:.4g}] N", peak_force(), low, high));
  }

  template <class Say> void judge_thread(Say& say, double dx) const {
    say("at least 4 segments embedded", last().embedded >= 4, fmt::format("{}", last().embedded));
    bool near = true;
    std::string where;
    for (auto const& c : crossings_) {
      near = near && c.to_track <= dx;
      where += fmt::format("{}{:.3g} m from the track", where.empty() ? "" : ", ", c.to_track);
    }
    say("the thread crosses the surface twice", crossings_.size() == 2,
        fmt::format("{} times", crossings_.size()));
    say("each crossing within a cell of the needle's track", !crossings_.empty() && near,
        crossings_.empty() ? std::string("no crossing") : where);
    // From the time that the needle's way out has ended; the thread alone is in tissue then.
    double const from = config_.duration() - free_pull_time();
    double least = bound::none;
    int count = 0;
    for (auto const& s : samples_)
      if (s.time > from + 1e-9) {
        least = std::min(least, std::min(s.pull, s.embedded > 0 ? s.least_tension : 0.0));
        ++count;
      }
    say("tension while the thread is pulled", count > 0 && least > 0.0,
        count > 0
            ? fmt::format("at least {:.4g} N, on {} segments at the end", least, last().embedded)
            : std::string("never pulled"));
  }
  double free_pull_time() const {
    auto const script = config_.script();
    return script.count > 2 ? script.moves[script.count - 1].duration : 0.0;
  }

  SuturingConfig config_;
  SuturePath path_;
  double angle_;
  std::vector<StitchSample> samples_{};
  std::vector<Event> events_{};
  std::vector<ThreadCrossing> crossings_{};
  double memory_ = 0.0;
};

}  // namespace mpmpbd::suturing
