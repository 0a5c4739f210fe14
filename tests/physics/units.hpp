// Units for tests that are thought of with cell, density and shear modulus 1 but run with other numbers,
// so that no factor can hide behind a one.
#pragma once

#include <cmath>

namespace test {

struct Units {
  double length = 0.5, density = 1.25, modulus = 3.2;  // a cell; of the tissue

  double mass() const { return density * length * length * length; }  // of a node
  double time() const { return length * std::sqrt(density / modulus); }
  double speed() const { return length / time(); }
  double impulse() const { return mass() * speed(); }
  double force() const { return modulus * length * length; }
  double energy() const { return force() * length; }
};

}  // namespace test
