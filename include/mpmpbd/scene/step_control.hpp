// The status and the clock of one environment through a step: the same text for every back end.
#pragma once

#include <mpmpbd/core/status.hpp>
#include <mpmpbd/core/tick.hpp>
#include <mpmpbd/mpm/time_step.hpp>
#include <mpmpbd/scene/held_limit.hpp>

namespace mpmpbd {

// How many substeps a step has.
struct SubstepChoice {
  int fixed = 0;    // 0: as many as the stable limit of the environment asks for
  int most = 1000;  // more needed than this sets Fault::time_step

  MPMPBD_HD int of(double h, double suggested) const {
    if (fixed > 0) return fixed;
    double const needed = h / suggested;
    if (!(needed <= most)) return most;
    return needed > 1.0 ? static_cast<int>(::ceil(needed - 1e-9)) : 1;
  }
};

// The suggestion holds a margin; only beyond the limit itself is a substep at fault.
MPMPBD_HD inline bool longer_than_limit(double dt, double suggested) {
  return dt > suggested / time_step_safety;
}

// The substeps of one step: all of one length.
template <class T> struct StepClock {
  int substeps;
  T dt;                      // [s]
  T previous_dt;             // of the last substep of the step before [s]
  std::int64_t step;         // substeps before this step
  std::int64_t time;         // before this step [ps]
  std::int64_t picoseconds;  // of a substep

  MPMPBD_HD Tick<T> tick(int s) const {
    return {dt,       s == 0 ? previous_dt : dt,
            step + s, T(1e-12 * double(time + s * picoseconds)),
            s,        substeps};
  }
};

// Env: an environment's fields (pbd/access.hpp). One lane calls.
template <class Env> struct StepControl {
  using T = typename Env::Scalar;
  Env env;

  MPMPBD_HD std::uint32_t status() const {
    return static_cast<std::uint32_t>(env.template get<environment::Status>(0));
  }
  MPMPBD_HD bool frozen() const { return has(status(), Fault::not_finite); }

  // Notes faults: each in the status word and in its counter. Once per substep.
  MPMPBD_HD void meet(std::uint32_t faults) const {
    if (faults == 0) return;
    env.template set<environment::Status>(0, static_cast<std::int64_t>(status() | faults));
    auto met = env.template get<environment::FaultCount>(0);
    for (int f = 0; f < fault_count; ++f) met[f] += (faults >> f) & 1u;
    env.template set<environment::FaultCount>(0, met);
  }

  // Begins a step of h [s] from what bounds it in the present state; notes the faults of choosing.
  MPMPBD_HD StepClock<T> begin(StepLimit<T> const& limit, double h,
                               SubstepChoice const& choice) const {
    env.template set<environment::DtLimit>(0, limit.dt);
    env.template set<environment::DtBound>(0, static_cast<std::int64_t>(limit.bound));
    int const substeps = choice.of(h, double(held(limit)));
    if (longer_than_limit(h / substeps, double(limit.dt)))
      meet(static_cast<std::uint32_t>(Fault::time_step));
    return clock(h, substeps);
  }
  // The clock of a step of h [s] with so many substeps.
  MPMPBD_HD StepClock<T> clock(double h, int substeps) const {
    T const dt = T(h / substeps), previous = env.template get<environment::Dt>(0);
    return {substeps,
            dt,
            previous > T(0) ? previous : dt,
            env.template get<environment::Step>(0),
            env.template get<environment::Time>(0),
            ::llround(1e12 * h / substeps)};
  }
  // Of the step before; 0 when there was none.
  MPMPBD_HD int substeps_before() const {
    return static_cast<int>(env.template get<environment::Substeps>(0));
  }

  // After `done` substeps of it.
  MPMPBD_HD void finish(StepClock<T> const& clock, int done) const {
    env.template set<environment::Step>(0, clock.step + done);
    env.template set<environment::Time>(0, clock.time + done * clock.picoseconds);
    env.template set<environment::Dt>(0, clock.dt);
    env.template set<environment::Substeps>(0, clock.substeps);
  }

 private:
  // The limit that chosen substeps keep [s]. How fast something moves does not swing with the strain, so it
  // holds nothing; a held limit that is shorter is let go by it as by another.
  MPMPBD_HD T held(StepLimit<T> const& now) const {
    if (now.bound == StepBound::none) return now.dt;
    auto const lengths = env.template get<environment::HeldLimits>(0);
    HeldLimit<T> held{lengths[0], lengths[1], env.template get<environment::CalmSteps>(0)};
    bool const is_longer = held.limit > T(0) && now.dt > held.limit;
    if (now.bound != StepBound::speed || is_longer) held.meet(now.dt);
    env.template set<environment::HeldLimits>(0, {{held.limit, held.longer}});
    env.template set<environment::CalmSteps>(0, held.calm);
    return held.limit > T(0) ? min(held.limit, now.dt) : now.dt;
  }
};
template <class Env> StepControl(Env) -> StepControl<Env>;

}  // namespace mpmpbd
