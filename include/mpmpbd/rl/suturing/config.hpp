// All numbers of the suturing task. Read from a scene and examples/scenes/suturing_task.toml.
#pragma once

#include <algorithm>
#include <cmath>

#include <mpmpbd/catalog/suturing_config.hpp>
#include <mpmpbd/rl/episode.hpp>

namespace mpmpbd::rl {

struct HandConfig {
  double speed = 0.3;
  double turn_rate = 0.8;
  double ramp_time = 0.1;

  void declare(ConfigKeys& keys) {
    keys(speed, bound::positive("speed_m_s", "m/s"), "of the needle's arc centre at action 1");
    keys(turn_rate, bound::positive("turn_rate_rad_s", "rad/s"), "of the needle at action 1");
    keys(ramp_time, bound::positive("ramp_time_s", "s"), "from rest to action 1");
  }
  bool operator==(HandConfig const&) const = default;
};

// The reference system leaves its weights open; these are ours. What can be had by waiting in a
// phase is worth less than what ends it: with gamma = 0.95 the closeness of the exit sums up to 20
// exit_closeness / least, below the bonus.
struct StitchRewardConfig {
  double entry_distance = 1.0;
  double entry_reached = 10.0;
  double turn_towards_exit = 5.0;
  double exit_closeness = 0.01;
  double exit_closeness_least = 0.0375;
  double exit_reached = 20.0;
  double centre_motion = 5.0;
  double finished = 50.0;

  void declare(ConfigKeys& keys) {
    auto weight = [&](double& w, char const* name, char const* unit, char const* docs) {
      keys(w, bound::not_negative(name, unit), docs);
    };
    weight(entry_distance, "entry_distance_per_m", "1/m", "w_e: paid for every metre to the entry");
    weight(entry_reached, "entry_reached", "1", "b_e: the tip has gone in at the entry");
    weight(turn_towards_exit, "turn_towards_exit_per_rad", "1/rad", "w_theta: turned to the exit");
    weight(exit_closeness, "exit_closeness_m", "m", "w_x: over the distance to the exit");
    keys(exit_closeness_least, bound::positive("exit_closeness_least_m", "m"),
         "below this distance it does not grow");
    weight(exit_reached, "exit_reached", "1", "b_x: the tip has come out at the exit");
    weight(centre_motion, "centre_motion_per_m", "1/m", "w_T: paid for motion of the arc's centre");
    weight(finished, "finished", "1", "b_n: enough of the needle is out");
  }
  bool operator==(StitchRewardConfig const&) const = default;
};

// Ranges in which episodes differ.
struct StitchRandomConfig {
  double shift = 0.15;
  double turn_deg = 20.0;
  double height = 0.2;
  double needle_radius = 1.04;
  double marker_shift = 0.05;
  double marker_closer = 0.02;
  double modulus = 1.2;
  double friction = 1.5;
  double thread_stiffness = 2.0;
  double camera_shift = 0.1;
  double colour = 1.15;

  void declare(ConfigKeys& keys) {
    keys(shift, bound::not_negative("shift_m", "m"), "start of the needle, to each side");
    keys(turn_deg, bound::between("turn_deg", "deg", 0.0, 90.0), "the same, turned");
    keys(height, bound::not_negative("height_m", "m"),
         "middle of the start above where the scripted hand starts");
    auto factor = [&](double& f, char const* name, char const* docs) {
      keys(f, {name, "1", 1.0, 100.0}, docs);
    };
    factor(needle_radius, "needle_radius_factor", "radius of the needle, larger by this at most");
    keys(marker_shift, bound::not_negative("marker_shift_m", "m"), "both markers, to each side");
    keys(marker_closer, bound::not_negative("marker_closer_m", "m"), "each towards the other");
    factor(modulus, "modulus_factor", "of the tissue: both Lame constants, each up or down");
    factor(friction, "friction_factor", "of needle and thread, up or down");
    factor(thread_stiffness, "thread_stiffness_factor", "of the thread in bending, up or down");
    keys(camera_shift, bound::not_negative("camera_shift_m", "m"), "of the eye, to each side");
    factor(colour, "colour_factor", "of the tissue's red, green and blue, up or down");
  }
  bool operator==(StitchRandomConfig const&) const = default;
};

// Pictures for those who see with a camera.
struct PictureConfig {
  int width = 250;
  int height = 250;

  void declare(ConfigKeys& keys) {
    keys(width, bound::between("width", "1", 8, 4096), "of the pictures that are observed");
    keys(height, bound::between("height", "1", 8, 4096), "of the same");
  }
  bool operator==(PictureConfig const&) const = default;
};

struct SuturingTaskConfig {
  SuturingConfig scene;
  EpisodeConfig episode;
  HandConfig hand;
  StitchRewardConfig reward;
  StitchRandomConfig random;
  PictureConfig picture;
  double reach = 0.075;
  double out_deg = 30.0;

  void declare(ConfigKeys& keys) {
    keys(reach, bound::positive("reach_m", "m"),
         "how far from its marker the tip may go through the surface");
    keys(out_deg, {"out_deg", "deg", 0.0, 180.0, true, false},
         "past the exit marker, when the stitch is finished");
    scene.declare(keys);
    keys.table(episode, "episode", "How time goes.");
    keys.table(hand, "hand", "What an action of 1 does.");
    keys.table(reward, "reward", "Weights of the reward terms.");
    keys.table(random, "random", "How episodes differ.");
    keys.table(picture, "picture", "What a camera shows.");
  }
  void check(ConfigRules& rules) const {
    scene.check(rules);
    check_markers(rules);
    check_start(rules);
    auto stiffest = scene;
    stiffest.tissue.young_modulus *= random.modulus;
    rules.require("random.modulus_factor",
                  !scene.time.strict || scene.time.substeps == 0 ||
                      scene.time.step / scene.time.substeps <= stiffest.stable_dt(),
                  "the stiffest tissue has a shorter stable substep than time.substeps gives; give "
                  "more of them, or time.strict = false");
  }
  bool operator==(SuturingTaskConfig const&) const = default;

 private:
  void check_markers(ConfigRules& rules) const {
    auto const way = scene.markers.exit - scene.markers.entry;
    rules.require("markers.exit_m", way[0] > 0.0 && way[1] == 0.0 && way[2] == 0.0,
                  "the task is planar; give the exit the y and z of the entry and a larger x");
    rules.number("random.marker_closer_m", random.marker_closer,
                 {.high = 0.5 * (way[0] - scene.markers.diameter)}, "the markers do not meet");
    double const edge = 0.5 * (scene.tissue.size[0] - scene.markers.diameter);
    double const room = edge - std::max(-scene.markers.entry[0], scene.markers.exit[0]);
    rules.number("random.marker_shift_m", random.marker_shift, {.high = room},
                 "the markers stay on the tissue");
  }
  // The lowest and most turned needle begins above the tissue.
  void check_start(ConfigRules& rules) const {
    if (!scene.no_script().empty()) return;  // the scene says so
    auto const start = scene.script().start;
    auto const tip = quaternion::rotate(start.orientation, vec(1.0, 0.0, 0.0));
    double const turn = std::atan2(tip[2], tip[0]);
    double const range = random.turn_deg * pi<double> / 180.0;
    double const radius = scene.needle.radius * random.needle_radius;
    double const lowest =
        radius * std::min(0.0, least_sine(turn - scene.needle.angle() - range, turn + range));
    double const least = scene.tissue.top()[2] + scene.needle.wire_radius - lowest -
                         start.position[2] + random.shift;
    rules.number("random.height_m", random.height, {.low = least},
                 "the lowest, most turned needle begins above the tissue");
  }
  // Of the angles from a to b [rad].
  static double least_sine(double a, double b) {
    constexpr double round = 2.0 * pi<double>;
    double const bottom = (std::ceil(a / round + 0.25) - 0.25) * round;  // the first from a on
    return bottom <= b ? -1.0 : std::min(std::sin(a), std::sin(b));
  }
};

}  // namespace mpmpbd::rl
