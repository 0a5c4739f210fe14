// A thread's material: what a round wire of given modulus, radius and density weighs and resists.
#pragma once

#include <mpmpbd/core/math.hpp>
#include <mpmpbd/core/parameters.hpp>

namespace mpmpbd {

struct RodMaterial {
  double young_modulus;  // [Pa]
  double radius;         // [m]
  double density;        // [kg/m^3]
  // Of the bending stiffness of a solid wire; the filaments of a braid slide, so it bends more easily.
  double bending_share = 1.0;

  double area() const { return pi<double> * radius * radius; }       // [m^2]
  double axial_stiffness() const { return young_modulus * area(); }  // EA [N]
  double bending_stiffness() const {
    return bending_share * axial_stiffness() * radius * radius / 4;
  }                                                         // EI [N m^2]
  double line_density() const { return density * area(); }  // [kg/m]
  // Compliance of a segment of length l [m]: l/EA [m/N].
  double stretch_compliance(double l) const { return l / axial_stiffness(); }
  // Compliance of a joint that stands for a length l [m] of thread: l/EI [rad/(N m)].
  double bend_compliance(double l) const { return l / bending_stiffness(); }

  // Refuses numbers that are not positive and finite: throws std::invalid_argument.
  void check() const {
    check_parameter("RodMaterial", bound::positive("young_modulus", "Pa"), young_modulus);
    check_parameter("RodMaterial", bound::positive("radius", "m"), radius);
    check_parameter("RodMaterial", bound::positive("density", "kg/m^3"), density);
    check_parameter("RodMaterial", bound::positive("bending_share", "1"), bending_share);
  }
};

}  // namespace mpmpbd
