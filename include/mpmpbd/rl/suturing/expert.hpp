// A scripted expert: it sews by what the task shows it, through actions alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <mpmpbd/rl/suturing/hand.hpp>
#include <mpmpbd/rl/suturing/observation.hpp>

namespace mpmpbd::rl {

// Brings the needle onto the circle through both markers, turns it about the circle's centre, and
// keeps the circle on the exit marker while the tissue moves. Reads the groups NeedlePose,
// TipAndMarkers and StitchState of one environment.
class SuturingExpert {
 public:
  // speed [m/s] and turn rate [rad/s] of an action of 1, time of a decision [s].
  SuturingExpert(double speed, double turn_rate, double decision_time)
      : speed_(speed), turn_rate_(turn_rate), time_(decision_time) {}

  // A new episode begins.
  void begin() { aligned_ = false; }

  // The action for the observations (newest frame) of one environment.
  void act(float const* needle_pose, float const* tip_and_markers, float const* stitch_state,
           float* action) {
    Vec3<double> const centre = read(needle_pose), tip = read(tip_and_markers),
                       entry = read(tip_and_markers + 3), exit = read(tip_and_markers + 6);
    double const radius = norm(tip - centre);
    bool const inserting = stitch_state[0] > 0.5f && stitch_state[3] < 0.5f;
    Vec3<double> const wanted = circle_centre(entry, exit, radius);
    Vec3<double> shift = wanted - centre;
    double const angle = plane::angle(entry - wanted, tip - centre);
    double turn = 0.0;
    if (inserting && !aligned_) {
      turn = -approach - angle;
      aligned_ = norm(shift) < 0.01 * radius && std::abs(turn) < 0.02;
      turn /= time_;
    } else {
      turn = pace * turn_rate_;
      // On its way the circle may only be moved gently: everything in tissue moves with it.
      if (!inserting) shift = towards(exit, centre, radius);
    }
    double const gain = inserting ? 1.0 / time_ : steering;
    Vec3<double> const velocity = gain * shift;
    action[0] = share(velocity[0], speed_);
    action[1] = share(velocity[2], speed_);
    action[2] = share(turn, turn_rate_);
  }

 private:
  static constexpr double approach = 0.35;  // before the entry marker, where the turn begins [rad]
  static constexpr double pace = 0.75;      // of the fastest turn
  static constexpr double steering = 0.5;   // [1/s]

  static Vec3<double> read(float const* x) { return vec(double(x[0]), double(x[1]), double(x[2])); }
  static float share(double wanted, double most) {
    return static_cast<float>(std::clamp(wanted / most, -1.0, 1.0));
  }
  // Above the middle of the markers, so that the circle goes through both.
  static Vec3<double> circle_centre(Vec3<double> const& entry, Vec3<double> const& exit,
                                    double radius) {
    Vec3<double> const half = 0.5 * (exit - entry);
    double const height = std::sqrt(std::max(radius * radius - dot(half, half), 0.0));
    return entry + half + height * direction(cross(plane::across<double>(), half));
  }
  // The smallest shift of the centre that brings the circle onto the marker.
  static Vec3<double> towards(Vec3<double> const& marker, Vec3<double> const& centre,
                              double radius) {
    Vec3<double> arm = marker - centre;
    arm[1] = 0.0;
    double const r = norm(arm);
    return r > 0.0 ? ((r - radius) / r) * arm : Vec3<double>{};
  }

  double speed_, turn_rate_, time_;
  bool aligned_ = false;
};

// One expert for each environment of a VectorEnv with the groups that it reads.
template <class Envs> class SuturingExperts {
 public:
  explicit SuturingExperts(Envs const& envs)
      : actions_(static_cast<std::size_t>(envs.num_envs() * Envs::action_size)),
        experts_(static_cast<std::size_t>(envs.num_envs()),
                 {envs.config().hand.speed, envs.config().hand.turn_rate, envs.decision_time()}) {}

  // What they do about what is seen now, (num_envs, action_size).
  std::span<float const> act(Envs const& envs) {
    for (std::int64_t env = 0; env < envs.num_envs(); ++env) {
      auto& expert = experts_[static_cast<std::size_t>(env)];
      if (envs.decisions(env) == 0) expert.begin();
      expert.act(envs.template newest<NeedlePose>(env).data(),
                 envs.template newest<TipAndMarkers>(env).data(),
                 envs.template newest<StitchState>(env).data(),
                 actions_.data() + env * Envs::action_size);
    }
    return actions_;
  }

 private:
  std::vector<float> actions_;
  std::vector<SuturingExpert> experts_;
};

}  // namespace mpmpbd::rl
