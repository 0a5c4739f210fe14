// The needle as a part of a scene: an arc of wire, moved by a script or a hand, or free to be
// moved.
#pragma once

#include <mpmpbd/core/parameters.hpp>
#include <mpmpbd/core/role.hpp>
#include <mpmpbd/geometry/arc.hpp>
#include <mpmpbd/needle/body.hpp>
#include <mpmpbd/needle/fields.hpp>

namespace mpmpbd {

// Its motion is given; tissue and thread act on what holds it, and the wrench says how much.
struct ArcNeedle {
  using Role = role::Needle;
  static constexpr FixedString name = "ArcNeedle";
  static constexpr bool is_dynamic = false;

  template <class T> struct Parameters {
    T radius;          // of the centre line [m]
    T angle;           // tip to blunt end [rad]
    T wire_radius;     // [m]
    T taper;           // length of the pointed part [m]
    T puncture_force;  // axial force at which the tip goes through the surface [N]
    T cutting_force;   // axial force on the tip in tissue [N]
  };
  static constexpr ParameterInfo parameter_info[] = {
      bound::positive("radius", "m"),
      {"angle", "rad", 0.0, 2.0 * pi<double>*(1.0 + 1e-7), false, true},
      bound::not_negative("wire_radius", "m"),
      bound::not_negative("taper", "m"),
      bound::not_negative("puncture_force", "N"),
      bound::not_negative("cutting_force", "N")};

  using Reads = needle::State;
  using Writes = needle::State;

  template <class T> MPMPBD_HD static Arc<T> arc(Parameters<T> const& k) {
    return {k.radius, k.angle, k.wire_radius, k.taper};
  }
};

// It has a mass and moves by the forces on it.
struct FreeArcNeedle {
  using Role = role::Needle;
  static constexpr FixedString name = "FreeArcNeedle";
  static constexpr bool is_dynamic = true;

  template <class T> struct Parameters {
    T radius;
    T angle;
    T wire_radius;
    T taper;
    T puncture_force;
    T cutting_force;
    T density;  // of the wire [kg/m^3]
  };
  static constexpr ParameterInfo parameter_info[] = {
      ArcNeedle::parameter_info[0],        ArcNeedle::parameter_info[1],
      bound::positive("wire_radius", "m"), ArcNeedle::parameter_info[3],
      ArcNeedle::parameter_info[4],        ArcNeedle::parameter_info[5],
      bound::positive("density", "kg/m^3")};

  using Reads = needle::State;
  using Writes = needle::State;

  template <class T> MPMPBD_HD static Arc<T> arc(Parameters<T> const& k) {
    return {k.radius, k.angle, k.wire_radius, k.taper};
  }
  template <class T> MPMPBD_HD static NeedleBody<T> body(Parameters<T> const& k) {
    return NeedleBody<T>::of(arc(k), k.density);
  }
};

// Refuses a needle whose numbers do not fit together, and one that is larger than its domain [m].
template <class Needle, class T>
void check_needle(typename Needle::template Parameters<T> const& k, Vec3<T> const& domain) {
  check_parameters<Needle, T>(k);
  check_arc(Needle::arc(k), "needle");
  T const smallest = min(domain[0], min(domain[1], domain[2]));
  check_parameter("needle", {"radius", "m", 0.0, static_cast<double>(smallest) / 2, false, true},
                  static_cast<double>(k.radius));
  check_parameter("needle", {"cutting_force", "N", 0.0, static_cast<double>(k.puncture_force)},
                  static_cast<double>(k.cutting_force));
}

}  // namespace mpmpbd
