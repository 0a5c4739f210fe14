// Without a GPU the run is refused with a sentence, and that is what this program then asks for.
#include <cstdio>
#include <cstring>

#include <mpmpbd/backend/cuda.hpp>
#include <mpmpbd/catalog/suturing.hpp>

using Run = mpmpbd::Simulation<mpmpbd::Suturing, mpmpbd::Cuda, float>;

int main() {
  mpmpbd::SuturingConfig config;
  config.domain.size = {{2.5, 1.5, 1.5}};
  config.tissue.corner = {{0.25, 0.25, 0.25}};
  try {
    Run run(mpmpbd::suturing::options(config, 2));
    for (std::int64_t env = 0; env < 2; ++env) mpmpbd::suturing::set_up(run, env, config);
    run.step(config.time.step);
    std::printf("%s\nstatus %u\n", run.execution().c_str(), run.status(1));
    return run.status(1) == 0 ? 0 : 1;
  } catch (std::runtime_error const& e) {
    std::printf("%s\n", e.what());
    return std::strstr(e.what(), "there are 0") != nullptr ? 0 : 1;
  }
}
