// A free block of gel with a straight thread through it along x, a little of it outside at both ends.
#pragma once

#include <mpmpbd/pbd/rod_builder.hpp>

#include "physics/back_end.hpp"
#include "physics/gel.hpp"

namespace test {

struct ThreadInGel {
  double mass_ratio = 1;        // of a bead and of a full node
  double axial_stiffness = 20;  // EA [N]
  double radius = 2e-4;         // [m], for EI = EA r^2 / 4
  double outside = 1.5;         // at each end [cells]
  double spacing = 0.75;        // of beads [cells]
  GelBlock block{.high = {11, 9, 9}, .substeps = 1};

  using Rods = Pbd<Constraints<Distance, Bend>>;
  int beads() const {
    return 1 +
           static_cast<int>(std::lround((block.high[0] - block.low[0] + 2 * outside) / spacing));
  }
  RodMaterial material() const {
    double const area = pi<double> * radius * radius;
    double const bead = mass_ratio * gel_density * gel_cell * gel_cell * gel_cell;
    return {axial_stiffness / area, radius, bead / (spacing * gel_cell) / area};
  }
  template <class Body> RodAssembly<Body> rod() const {
    double const y = 0.5 * (block.low[1] + block.high[1]) + 0.13,
                 z = 0.5 * (block.low[2] + block.high[2]) - 0.21, x = block.low[0] - outside;
    std::vector<Vec3<double>> const line{gel_cell * vec(x, y, z),
                                         gel_cell * vec(x + (beads() - 1) * spacing, y, z)};
    RodAssembly<Body> rod;
    add_thread(rod, std::span<Vec3<double> const>(line), beads(), material());
    return rod;
  }
  template <class S, class T, class Backend = BackEnd>
  Simulation<S, Backend, T> make(Backend backend = {}) const {
    auto const thread = rod<typename S::Rods>();
    auto capacity = thread.capacity();
    capacity.push_back({ContactPoints::name.view(), beads()});
    Simulation<S, Backend, T> run(block.options(capacity), backend);
    block.fill(run);
    run.template set<Embedded>({radius});
    for (int e = 0; e < block.environments; ++e) {
      thread.write(run.state(), e);
      run.state().template table<ContactPoints>().set_live(e, beads());
    }
    return run;
  }
};

}  // namespace test
