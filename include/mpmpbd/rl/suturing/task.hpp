// The suturing task: a needle that is held is to go in at one marker and to come out at the other,
// its thread behind it.
//
// Planar, after the reference system. See docs/concepts/suturing_task.md for every constant and its
// source.
#pragma once

#include <mpmpbd/catalog/suturing.hpp>
#include <mpmpbd/rl/suturing/config.hpp>
#include <mpmpbd/rl/suturing/parts.hpp>
#include <mpmpbd/rl/suturing/picture.hpp>

namespace mpmpbd::rl {

// The task with the observation groups `Groups`, and what they need besides.
template <class... Groups> struct SuturingWith : SuturingParts<Groups...> {
  using Config = SuturingTaskConfig;

  static SimulationOptions options(Config const& c, std::int64_t environments) {
    auto largest = c.scene;
    largest.needle.radius *= c.random.needle_radius;
    return suturing::options(largest, environments);
  }

  static double step_time(Config const& c) { return c.scene.time.step; }

  template <class Sim> static void set_up(Sim& sim, std::int64_t env, Config const& c) {
    suturing::set_up(sim, env, c.scene);
    set_rules(sim, env, c);
    set_rewards(sim, env, c.reward);
    set_ranges(sim, env, c);
  }

 private:
  static constexpr double degree = pi<double> / 180.0;

  template <class Sim> static void set_rules(Sim& sim, std::int64_t env, Config const& c) {
    auto const& h = c.hand;
    sim.template set<MoveNeedle>(
        env, {h.speed, h.turn_rate, h.speed / h.ramp_time, h.turn_rate / h.ramp_time});
    auto const top = c.scene.tissue.top();
    sim.template set<StitchProgress>(env, {c.reach, c.out_deg * degree, top[0], top[1], top[2]});
  }
  template <class Sim>
  static void set_rewards(Sim& sim, std::int64_t env, StitchRewardConfig const& r) {
    sim.template set<EntryDistance>(env, {r.entry_distance});
    sim.template set<EntryReached>(env, {r.entry_reached});
    sim.template set<TurnTowardsExit>(env, {r.turn_towards_exit});
    sim.template set<ExitCloseness>(env, {r.exit_closeness, r.exit_closeness_least});
    sim.template set<ExitReached>(env, {r.exit_reached});
    sim.template set<CentreMotion>(env, {r.centre_motion});
    sim.template set<StitchFinished>(env, {r.finished});
  }
  template <class Sim> static void set_ranges(Sim& sim, std::int64_t env, Config const& c) {
    auto const& r = c.random;
    auto const& s = c.scene;
    auto either_way = [](double f) { return std::pair{1.0 / f, f}; };
    auto const [softest, stiffest] = either_way(r.modulus);
    sim.template set<RandomTissue>(env, {softest, stiffest});
    auto const [smoothest, roughest] = either_way(r.friction);
    sim.template set<RandomFriction>(env, {smoothest, roughest});
    auto const [slackest, stiffest_thread] = either_way(r.thread_stiffness);
    sim.template set<RandomThread>(env, {slackest, stiffest_thread});
    sim.template set<RandomNeedle>(env, {1.0, r.needle_radius});
    auto const entry = s.entry(), exit = s.exit();
    sim.template set<RandomMarkers>(
        env, {entry[0], exit[0], entry[1], entry[2], r.marker_shift, r.marker_closer});
    if constexpr ((std::is_same_v<Groups, RandomLook> || ...))
      sim.template set<RandomLook>(env, {r.camera_shift, r.colour});
    auto const start = s.script().start;
    auto const tip = quaternion::rotate(start.orientation, vec(1.0, 0.0, 0.0));
    double const above = 0.1 * s.domain.cell_size + s.thread.radius;
    sim.template set<RandomStart>(
        env, {start.position[0], start.position[1], start.position[2] + r.height,
              std::atan2(tip[2], tip[0]), r.shift, r.turn_deg * degree, s.tissue.top()[2] + above,
              0.9 * s.needle.radius});
  }
};

// State observations: all that a policy without a camera can know.
struct SuturingTask : SeenByState<SuturingWith> {};

// The reference system's: a picture, and where the needle is. It stacks three: episode.frames = 3.
struct SuturingFromPictures : SuturingWith<CameraPicture, NeedlePose, RandomLook> {};

}  // namespace mpmpbd::rl
