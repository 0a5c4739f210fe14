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
  double poisson_ratio = 0.4;  // for twist and shear

  double area() const { return pi<double> * radius * radius; }       // [m^2]
  double axial_stiffness() const { return young_modulus * area(); }  // EA [N]
  double bending_stiffness() const {
    return bending_share * axial_stiffness() * radius * radius / 4;
  }                                                                                   // EI [N m^2]
  double shear_modulus() const { return young_modulus / (2 * (1 + poisson_ratio)); }  // [Pa]
  // GJ [N m^2], J = pi r^4 / 2.
  double torsional_stiffness() const { return shear_modulus() * area() * radius * radius / 2; }
  // k G A [N], k of Timoshenko's beam with a round section (Cowper 1966).
  double shear_stiffness() const {
    return 6 * (1 + poisson_ratio) / (7 + 6 * poisson_ratio) * shear_modulus() * area();
  }
  double line_density() const { return density * area(); }  // [kg/m]
  // Compliance of a segment of length l [m]: l/EA [m/N].
  double stretch_compliance(double l) const { return l / axial_stiffness(); }
  // Compliance of a joint that stands for a length l [m] of thread: l/EI [rad/(N m)].
  double bend_compliance(double l) const { return l / bending_stiffness(); }
  // The same against twist, l/GJ [rad/(N m)], and of a segment against shear, l/(k G A) [m/N].
  double twist_compliance(double l) const { return l / torsional_stiffness(); }
  double shear_compliance(double l) const { return l / shear_stiffness(); }
  // Of a segment of length l [m] about its own axis, m r^2 / 2 [kg m^2].
  double axial_inertia(double l) const { return line_density() * l * radius * radius / 2; }

  // Refuses numbers that are not positive and finite: throws std::invalid_argument.
  void check() const {
    check_parameter("RodMaterial", bound::positive("young_modulus", "Pa"), young_modulus);
    check_parameter("RodMaterial", bound::positive("radius", "m"), radius);
    check_parameter("RodMaterial", bound::positive("density", "kg/m^3"), density);
    check_parameter("RodMaterial", bound::positive("bending_share", "1"), bending_share);
    check_parameter("RodMaterial", {"poisson_ratio", "1", -1.0, 0.5, false, true}, poisson_ratio);
  }
};

}  // namespace mpmpbd
