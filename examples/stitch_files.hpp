// What the stitch leaves in its folder: time series, summary, files for ParaView, pictures and video.
#pragma once

#include "stitch_options.hpp"

#include <mpmpbd/catalog/suturing_picture.hpp>
#include <mpmpbd/catalog/suturing_report.hpp>
#include <mpmpbd/io/csv.hpp>
#include <mpmpbd/io/progress.hpp>
#include <mpmpbd/io/summary.hpp>
#include <mpmpbd/io/video.hpp>
#include <mpmpbd/io/vtk.hpp>
#include <mpmpbd/scene/totals.hpp>

namespace course {

class StitchFiles {
 public:
  explicit StitchFiles(StitchOptions const& run)
      : run_(run),
        picture_(run.config),
        series_(run.out / "stitch.csv", columns()),
        paraview_(run.out / "stitch.pvd") {
    std::filesystem::create_directories(run.out / "paraview");
  }

  // A row per step.
  template <class Sim> void row(Sim const& sim, mpmpbd::suturing::StitchSample const& s) {
    if (rows_++ % 10 == 0)
      energy_ = mpmpbd::tissue_totals(sim, 0);  // it costs as much as a substep
    most_kinetic_ = std::max(most_kinetic_, energy_.kinetic);
    most_elastic_ = std::max(most_elastic_, energy_.strain);
    series_.row({s.time, s.depth, s.force[0], s.force[1], s.force[2], s.moment[0], s.moment[1],
                 s.moment[2], norm(s.force), s.peak_force, s.tip_force, s.pull, s.most_tension,
                 s.least_tension, double(s.embedded), double(s.status), double(s.substeps),
                 energy_.kinetic, energy_.strain});
  }

  // The scene as ParaView opens it.
  template <class Sim> void snapshot(Sim const& sim, double time) {
    auto const m = mpmpbd::suturing::Moment::of(sim, 0, time);
    auto const name = [&](char const* part) {
      return run_.out / "paraview" / fmt::format("{}_{}.vtp", part, std::lround(1000 * time));
    };
    auto const skin = picture_.skin(m);
    using Points = std::span<mpmpbd::Vec3<float> const>;
    mpmpbd::io::write_vtp_surface<float>(name("tissue"), Points(skin.positions),
                                         std::span<mpmpbd::Vec3<int> const>(skin.triangles));
    std::vector<float> tension;
    for (std::size_t k = 0; k < m.thread.size(); ++k)
      tension.push_back(float(sim.state().template get<mpmpbd::bead::Tension>(0, std::int64_t(k))));
    mpmpbd::io::DataArray const data[] = {mpmpbd::io::data_array("tension [N]", tension)};
    mpmpbd::io::write_vtp_line<float>(name("thread"), Points(m.thread), data);
    auto const wire = picture_.needle_line(m.needle);
    mpmpbd::io::write_vtp_line<float>(name("needle"), Points(wire));
    int part = 0;
    for (auto const* which : {"tissue", "thread", "needle"})
      paraview_.add(time, name(which), part++);
  }

  template <class Sim>
  void finish(Sim const& sim, mpmpbd::suturing::StitchReport const& report, double seconds,
              std::int64_t substeps) {
    series_.close();
    mpmpbd::io::write_json(run_.out / "summary.json", summary(sim, report, seconds, substeps));
  }

  // Both videos, a picture per snapshot, and the last one of each size.
  void draw(std::vector<mpmpbd::suturing::Moment> const& moments) const {
    auto const& o = run_.config.output;
    mpmpbd::io::Video large(run_.out / "stitch.mp4", o.width, o.height, o.frames_per_second);
    mpmpbd::io::Video small(run_.out / "stitch_small.mp4", o.small_width, o.small_height,
                            o.frames_per_second);
    std::filesystem::create_directories(run_.out / "pictures");
    auto const lanes = static_cast<std::size_t>(run_.threads.lanes());
    std::vector<mpmpbd::suturing::Canvas> with(lanes);
    std::vector<mpmpbd::render::Image> wide(lanes), square(lanes);
    mpmpbd::io::Progress progress(std::int64_t(moments.size()), "drawing", "frames");
    for (std::size_t first = 0; first < moments.size(); first += lanes) {
      std::size_t const count = std::min(lanes, moments.size() - first);
      run_.threads.for_each(std::int64_t(count), [&](std::int64_t i, int) {
        auto const k = std::size_t(i);
        picture_.draw(with[k], moments[first + k], o.width, o.height, wide[k]);
        picture_.draw(with[k], moments[first + k], o.small_width, o.small_height, square[k]);
      });
      for (std::size_t k = 0; k < count; ++k) {
        large.add(wide[k]);
        small.add(square[k]);
        if (is_snapshot(moments[first + k].time))
          mpmpbd::io::write_png(
              run_.out / "pictures" /
                  fmt::format("{}.png", std::lround(1000 * moments[first + k].time)),
              wide[k]);
      }
      progress.update(std::int64_t(first + count));
      if (first + count == moments.size()) {
        mpmpbd::io::write_png(run_.out / "stitch.png", wide[count - 1]);
        mpmpbd::io::write_png(run_.out / "stitch_small.png", square[count - 1]);
      }
    }
    fmt::print("{}\n{}\n", large.finish(), small.finish());
  }

 private:
  static std::vector<mpmpbd::io::Csv::Column> columns() {
    return {{"time", "s"},
            {"depth", "m"},
            {"force x", "N"},
            {"force y", "N"},
            {"force z", "N"},
            {"moment x", "N m"},
            {"moment y", "N m"},
            {"moment z", "N m"},
            {"force", "N"},
            {"peak force", "N"},
            {"tip force", "N"},
            {"thread pull", "N"},
            {"largest tension", "N"},
            {"smallest tension", "N"},
            {"embedded segments", "1"},
            {"status", "1"},
            {"substeps", "1"},
            {"kinetic energy", "J"},
            {"elastic energy", "J"}};
  }

  bool is_snapshot(double time) const {
    double const interval = run_.config.output.snapshot_interval;
    return std::abs(std::remainder(time, interval)) < 0.5 * run_.config.time.step;
  }

  template <class Sim>
  mpmpbd::io::Json summary(Sim const&, mpmpbd::suturing::StitchReport const& report, double seconds,
                           std::int64_t substeps) const {
    using mpmpbd::io::Json;
    using mpmpbd::io::quantity;
    auto const& c = run_.config;
    Json j;
    j["preset"] = run_.preset;
    j["coupled"] = run_.coupled;
    j["particles"] = c.tissue.point_count();
    j["steps"] = run_.steps;
    j["substeps"] = substeps;
    j["miss at entry"] = miss(report, mpmpbd::EventKind::entry);
    j["miss at exit"] = miss(report, mpmpbd::EventKind::exit);
    j["peak needle force"] = quantity(report.peak_force(), "N");
    j["mean needle force"] = quantity(report.mean_force(), "N");
    j["peak thread tension"] = quantity(report.peak_tension(), "N");
    j["thread pull at the end"] = quantity(report.last().pull, "N");
    j["embedded segments"] = report.last().embedded;
    j["crossings"] = report.crossings().size();
    j["kinetic energy of the tissue at the end"] = quantity(energy_.kinetic, "J");
    j["elastic energy of the tissue at the end"] = quantity(energy_.strain, "J");
    j["largest kinetic energy"] = quantity(most_kinetic_, "J");
    j["largest elastic energy"] = quantity(most_elastic_, "J");
    j["computing time"] = quantity(seconds, "s");
    j["rate"] = quantity(run_.steps / seconds, "steps/s");
    j["speed"] =
        quantity(double(substeps) * c.tissue.point_count() / seconds, "particle-substeps/s");
    j["threads"] = run_.threads.lanes();
    j["peak memory"] = quantity(mpmpbd::suturing::peak_memory(), "byte");
    j["status"] = mpmpbd::suturing::faults_in_words(report.last().status);
    bool good = true;
    for (auto const& v : report.verdicts()) {
      j["checks"].push_back({{"check", v.name}, {"holds", v.holds}, {"found", v.finding}});
      good = good && v.holds;
    }
    j["verdict"] = good ? "this is a stitch" : "this is not a stitch";
    return j;
  }
  static mpmpbd::io::Json miss(mpmpbd::suturing::StitchReport const& report,
                               mpmpbd::EventKind kind) {
    auto const* e = report.event(kind);
    if (e == nullptr) return nullptr;
    return {{"value", e->miss}, {"unit", "m"}, {"time", e->time}, {"force", e->force}};
  }

  StitchOptions run_;
  mpmpbd::suturing::StitchPicture picture_;
  mpmpbd::io::Csv series_;
  mpmpbd::io::TimeSeries paraview_;
  mpmpbd::Totals energy_{};
  double most_kinetic_ = 0.0, most_elastic_ = 0.0;
  std::int64_t rows_ = 0;
};

}  // namespace course
