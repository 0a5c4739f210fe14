// A4.7: action equals reaction, and energy has a place to be. What the coupling says that tissue does to needle
// and thread, against what the grid's nodes have gained.
// seconds: 25
// processors: 2
#include <mpmpbd/backend/threads.hpp>
#include <mpmpbd/catalog/suturing.hpp>

#include "catch.hpp"

#include "physics/needle_in_gel.hpp"
#include "physics/scales.hpp"
#include "physics/thread_in_gel.hpp"

using namespace test;

namespace {

template <class... Laws>
struct NeedleOnScales : Scene<Gel, ArcNeedle, OnScales<Laws...>, Damping, Walls<Sticky>> {};
struct ThreadOnScales : Scene<Gel, ThreadInGel::Rods, OnScales<Friction, Drag>, Gravity> {};
struct StitchOnScales : Scene<SoftTissue, Suture, ArcNeedle, Surface, OnScales<Friction, Drag>,
                              Gravity, Viscosity, Air, Floor> {};

// How far the impulses of all bodies are from minus those of the nodes, in shares of the sum of the sizes of all
// contact impulses [and the longest arm]; watched over steps of one substep.
template <class Sim> class Watch {
 public:
  double impulse = 0, moment = 0, largest = 0;  // largest contact impulse [N s]

  Watch(Sim const& run, std::int64_t env) : run_(run), env_(env) {}
  // Call before a step: where contact will act.
  void before() {
    beads_.clear();
    if constexpr (has<Beads>)
      for (std::int64_t k = 0; k < run_.state().template table<Beads>().live(env_); ++k)
        beads_.push_back(get<bead::Position>(k));
    if constexpr (has<Needles>) centre_ = get<needle::Position>(0);
  }
  void after(double h) {
    Vec3<double> force{}, couple{};  // impulses and their moments, of bodies on tissue
    double size = 0, arm = norm(centre_);
    for (std::int64_t q = 0; q < run_.state().template table<ContactPoints>().live(env_); ++q) {
      auto const J = get<contact::Impulse>(q);
      size += norm(J);
      largest = std::max(largest, norm(J));
      if (q >= std::ssize(beads_)) continue;  // the needle speaks for itself
      auto const& x = beads_[static_cast<std::size_t>(q)];
      force += J;
      couple += cross(x, J);
      arm = std::max(arm, norm(x));
    }
    if constexpr (has<Needles>) {
      auto const J = -h * get<needle::Force>(0);
      force += J;
      couple += cross(centre_, J) - h * get<needle::Moment>(0);
    }
    if (!(size > 0)) return;
    impulse = std::max(impulse, norm(force - of_grid<scales::Impulse>()) / size);
    moment = std::max(moment, norm(couple - of_grid<scales::Moment>()) / (size * arm));
  }

 private:
  template <class Domain>
  static constexpr bool has = on_t<typename Sim::Store::List, Domain>::count > 0;
  template <class F> Vec3<double> get(std::int64_t slot) const {
    return cast<double>(run_.state().template get<F>(env_, slot));
  }
  template <class F> Vec3<double> of_grid() const {
    return cast<double>(run_.state().template get<F>(env_));
  }
  Sim const& run_;
  std::int64_t env_;
  std::vector<Vec3<double>> beads_;
  Vec3<double> centre_{};
};

template <class T> constexpr double rounding = sizeof(T) == 4 ? 1e-6 : 1e-14;

// A straight needle along x through the middle of a block that is held all round.
template <class T> struct Rod {
  using Run = Simulation<NeedleOnScales<Friction, Drag>, Serial, T>;
  static constexpr double wire = 3e-4, length = 6.3 * gel_cell;
  Arc<double> arc = straight_needle(length, wire);
  Run run;

  static GelBlock block() {
    GelBlock b{.high = {17, 13, 13}, .substeps = 1};
    for (int a = 0; a < 3; ++a) b.held_high[a] = b.high[a];
    return b;
  }
  Rod() : run(gel_scene<NeedleOnScales<Friction, Drag>, T>(block(), arc)) {
    run.template set<Friction>({0.2, 2e3});
    run.template set<Drag>({2.0});
    place_needle(run, 0,
                 straight_pose(arc, gel_cell * vec(12.6, 8.13, 7.9), vec(1.0, 0.0, 0.0),
                               vec(0.0, 1.0, 0.0)));
  }
};

// A needle that has done `needle` on the gel, of which `gel` arrived [J].
struct Work {
  double needle = 0, gel = 0;
  double least_loss = 0;       // of an exchange: work of the needle less kinetic energy [J]
  double square_of_speed = 0;  // integrated over time [m^2/s]
};

// Moves by so many cells in a direction, with a gentle start and end.
template <class T>
void move(Rod<T>& rod, Vec3<double> const& way, double cells, double speed, Work& w) {
  double const h = 0.25 * gel_time();
  int const steps = static_cast<int>(cells / (0.25 * speed));
  for (int i = 0; i < steps; ++i) {
    double const t = (i + 0.5) / steps, ramp = std::min({1.0, 4 * t, 4 * (1 - t)}) / 0.75;
    auto const v = ramp * speed * gel_shear_speed() * way;
    drive_needle(rod.run, 0, v, {});
    rod.run.step(h);
    double const given =
        -h * dot(cast<double>(rod.run.state().template get<needle::Force>(0, 0)), v);
    double const arrived = double(rod.run.state().template get<scales::Work>(0));
    w.needle += given;
    w.gel += arrived;
    w.least_loss =
        std::min(w.least_loss, given - double(rod.run.state().template get<scales::Kinetic>(0)));
    w.square_of_speed += h * dot(v, v);
  }
}

}  // namespace

TEMPLATE_TEST_CASE("a needle in gel feels what it does", "[coupling][embedded][reaction]", double,
                   float) {
  Rod<TestType> rod;
  Watch watch(rod.run, 0);
  for (int i = 0; i < 80; ++i) {  // aside, along and round
    double const v = 0.05 * gel_shear_speed(), a = 0.1 * i;
    drive_needle(rod.run, 0, v * vec(std::cos(a), std::sin(a), 0.3), {});
    watch.before();
    rod.run.step(0.25 * gel_time());
    watch.after(0.25 * gel_time());
  }
  CAPTURE(watch.impulse, watch.moment, watch.largest);
  CHECK(watch.impulse < rounding<TestType>);
  CHECK(watch.moment < rounding<TestType>);
  CHECK(watch.largest > 0);
  CHECK(rod.run.status(0) == 0);
}

TEMPLATE_TEST_CASE("a thread in gel feels what it does", "[coupling][embedded][reaction]", double,
                   float) {
  ThreadInGel const thread;
  auto run = thread.make<ThreadOnScales, TestType>();
  run.template set<Friction>({0.2, 2e3});
  run.template set<Drag>({2.0});
  run.template set<Gravity>({{0.0, 0.0, 0.0}});
  auto& beads = run.state().template table<Beads>();
  for (std::int64_t k = 0; k < thread.beads(); ++k)
    beads.template set<bead::Velocity>(
        0, k, cast<TestType>(0.05 * gel_shear_speed() * vec(0.6, 0.8, 0.1 * double(k))));
  auto momentum = [&] {
    Vec3<double> p{};
    for (std::int64_t k = 0; k < thread.beads(); ++k)
      p += (1 / double(beads.template get<bead::InverseMass>(0, k))) *
           cast<double>(beads.template get<bead::Velocity>(0, k));
    return p;
  };
  Watch watch(run, 0);
  double thread_error = 0;
  auto const start = momentum();
  auto before = start;
  for (int i = 0; i < 80; ++i) {
    watch.before();
    run.step(0.25 * gel_time());
    watch.after(0.25 * gel_time());
    auto const lost = before - momentum();
    before = momentum();
    thread_error = std::max(
        thread_error,
        norm(lost - cast<double>(run.state().template get<scales::Impulse>(0))) / norm(start));
  }
  CAPTURE(watch.impulse, watch.moment, watch.largest, thread_error);
  CHECK(watch.impulse < rounding<TestType>);
  CHECK(watch.moment < rounding<TestType>);
  CHECK(thread_error < rounding<TestType>);
  CHECK(norm(before) < 0.5 * norm(start));
  CHECK(run.status(0) == 0);
}

TEST_CASE("needle and thread of several environments feel what they do",
          "[coupling][embedded][reaction]") {
  SuturingConfig c;
  c.tissue.size = vec(1.2, 0.6, 0.6);
  c.tissue.points = Vec<int, 3>{{22, 11, 11}};
  c.tissue.corner = vec(0.9, 0.7, 0.3);
  c.time.substeps = 1;
  constexpr int environments = 3;
  Simulation<StitchOnScales, Threads, float> run(suturing::options(c, environments));
  for (int e = 0; e < environments; ++e) {
    auto own = c;
    own.tissue.young_modulus *= 1 - 0.1 * e;
    own.contact.friction = 0.1 * e;
    suturing::set_up(run, e, own);
    auto const pose = needle::pose(run.state().view<Needles>(), e);
    drive_needle(
        run, e, {},
        (16.0 + e) * cast<double>(quaternion::rotate(pose.orientation, vec(0.0f, 0.0f, 1.0f))));
  }
  std::vector<Watch<decltype(run)>> watches;
  for (int e = 0; e < environments; ++e) watches.emplace_back(run, e);
  double const h = 1e-3;
  for (int i = 0; i < 80; ++i) {
    for (auto& w : watches) w.before();
    run.step(h);
    for (auto& w : watches) w.after(h);
  }
  for (int e = 0; e < environments; ++e) {
    auto const& w = watches[static_cast<std::size_t>(e)];
    CAPTURE(e, w.impulse, w.moment, w.largest);
    CHECK(w.impulse < rounding<float>);
    CHECK(w.moment < rounding<float>);
    CHECK(run.state().get<event::Count>(e) >= 1);  // it is in
    CHECK(run.status(e) == 0);
  }
}

TEST_CASE("the work of a needle is stored in the gel or lost to friction",
          "[coupling][embedded][reaction][energy]") {
  Rod<double> rod;
  Work w;
  double const far = 1.5 * gel_cell;
  // Drawn along itself: nearly all is lost to friction and drag, and no exchange gives energy.
  move(rod, vec(1.0, 0.0, 0.0), 1.5, 0.02, w);
  CHECK(w.least_loss > -1e-9 * w.needle);
  double const expected =
      Rod<double>::length *
      (0.2 * 2e3 * 2 * pi<double> * Rod<double>::wire * far + 2.0 * w.square_of_speed);
  CAPTURE(w.needle - w.gel, expected);
  CHECK(std::abs((w.needle - w.gel) / expected - 1) < 0.02);
  // Pushed aside: what arrives in the gel stays there.
  move(rod, vec(0.0, 0.0, 1.0), 0.5, 0.01, w);
  double const stored = gel_energy(rod.run, 0);
  CAPTURE(w.needle, w.gel, stored, w.least_loss);
  CHECK(std::abs(w.gel - stored) < 0.02 * w.gel);  // measured 0.011
  CHECK(w.gel > 0.5 * w.needle);
  CHECK(w.least_loss > -1e-9 * w.needle);
}
