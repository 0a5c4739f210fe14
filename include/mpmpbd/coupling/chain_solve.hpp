// Direct solve of a chain of beads in mixed form: new bead velocities V_k and link impulses lambda_k.
//
//   A_k V_k + U_k V_{k+1} + W_k V_{k+2} + (transposed terms of k-1, k-2)
//                                       - n_k lambda_k + n_{k-1} lambda_{k-1} = r_k
//   n_k . (V_{k+1} - V_k) - c_k lambda_k = g_k
//
// The mixed form keeps a stiff thread accurate in float: its stiffness enters as the compliance c_k,
// not as a large number added to masses, and lambda is an unknown, never a small difference of lengths.
// One pass up the chain eliminates bead k together with the link on its left. That order works for
// inextensible links (c = 0) behind a bead of known velocity too, where a link has no other pivot.
#pragma once

#include <mpmpbd/coupling/dense_solve.hpp>

namespace mpmpbd {

// The matrix blocks of a bead. W couples it to the next but one and exists only where the thread bends.
template <class T, bool bends> struct BeadBlocks { Mat3<T> A, U; };
template <class T> struct BeadBlocks<T, true> { Mat3<T> A, U, W; };

// The link from bead k to k+1. A gap between two threads has direction 0, compliance 1, and U = W = 0.
template <class T> struct Link {
  Vec3<T> direction;  // n
  T compliance;       // c [1/kg]; 0: inextensible
};

// What elimination leaves behind for one bead: V = inverse b + edge rho, lambda = edge . b - scale rho,
// the inverse of the bordered block [A p; p^T -gamma], where p is the left link as this bead feels it.
template <class T, bool bends> struct BeadFactor {
  Mat3<T> inverse, U;
  Vec3<T> edge;
  T scale;
};
template <class T> struct BeadFactor<T, true> : BeadFactor<T, false> {
  Mat3<T> W;
  Vec3<T> beyond;  // the left link as the next bead feels it
};

// A rigid body that ends the chain: six unknowns, velocity of its reference point and spin.
// `swaged`: the last bead is fixed to the body at `arm` from the reference point and has no unknowns.
template <class T> struct RigidEnd {
  Mat<T, 6, 6> matrix;
  Vec3<T> arm;
  bool present, swaged;
};

template <class T, bool bends> struct ChainSystem {
  int beads;
  BeadBlocks<T, bends> const* blocks;  // beads
  Link<T> const* links;                // beads - 1
  bool const* known;                   // beads; a known velocity leaves the system, its row drops
  RigidEnd<T> const* end;              // may be null
};

template <class T, bool bends> struct ChainFactors {
  BeadFactor<T, bends>* beads;
  Mat<T, 7, 7>* end;  // rigid body and the link that ends on it; needed with a rigid end
};

namespace detail {

// Cofactors of a symmetric positive definite matrix, and its determinant, by A = L D L^T: products of pivots.
// Differences of products of its entries, the usual way, can leave nothing of a small determinant in float (a light
// bead that leans on the tissue in one direction).
template <class T> struct Cofactors {
  Mat3<T> matrix;
  T determinant;
};
template <class T> MPMPBD_HD Cofactors<T> definite_cofactors(Mat3<T> const& A) {
  T const least = epsilon<T> * trace(A);
  T const d1 = max(A(0, 0), least), l21 = A(1, 0) / d1, l31 = A(2, 0) / d1;
  T const d2 = max(A(1, 1) - l21 * A(1, 0), least), l32 = (A(2, 1) - l31 * A(1, 0)) / d2;
  T const d3 = max(A(2, 2) - l31 * A(2, 0) - l32 * l32 * d2, least);
  Vec3<T> const m2 = vec(-l21, T(1), T(0)), m3 = vec(l21 * l32 - l31, -l32, T(1));  // rows of L^-1
  Mat3<T> C = d1 * d3 * outer(m2, m2) + d1 * d2 * outer(m3, m3);
  C(0, 0) += d2 * d3;
  return {C, d1 * d2 * d3};
}

// Inverse of [A p; p^T -gamma], gamma >= 0, without subtraction: with C the cofactors of A,
//   (A + p p^T / gamma)^-1 = (gamma C + [p]x A [p]x^T) / (gamma det A + p . C p).
// It stays exact for gamma -> 0 and for a tiny A. A is scaled to trace 1, so that float does not underflow.
template <class T, bool bends>
MPMPBD_HD bool invert_bordered(Mat3<T> A, Vec3<T> const& p, T gamma, BeadFactor<T, bends>& f) {
  T const size = trace(A);
  if (!(size > T(0)) || !is_finite(size)) return false;
  A *= T(1) / size;
  gamma *= size;
  auto const [C, det] = definite_cofactors(A);
  Vec3<T> const Cp = C * p;
  T const denominator = gamma * det + dot(p, Cp);
  if (!(denominator > square(epsilon<T>) * (gamma + dot(p, p)))) return false;
  Mat3<T> const cross_p = skew(p);
  f.inverse = T(1) / (denominator * size) * (gamma * C - cross_p * A * cross_p);
  f.edge = T(1) / denominator * Cp;
  f.scale = det / denominator * size;
  return is_finite(f.inverse) && is_finite(f.scale);
}

// A known bead: its left link alone remains.
template <class T, bool bends>
MPMPBD_HD bool border_of_known(Vec3<T> const& p, T gamma, BeadFactor<T, bends>& f) {
  if (!(gamma > T(0))) return false;  // an inextensible link between two known velocities
  f.inverse = {};
  f.scale = T(1) / gamma;
  f.edge = f.scale * p;
  return true;
}

// The velocity of the swaged bead is R y, R = [I, -[arm]x]: row blocks of R^T.
template <class T> MPMPBD_HD Vec<T, 6> lift(Vec3<T> const& arm, Vec3<T> const& a) {
  Vec3<T> const moment = cross(arm, a);
  return {{a[0], a[1], a[2], moment[0], moment[1], moment[2]}};
}
template <class T> MPMPBD_HD Vec3<T> velocity_at(Vec<T, 6> const& y, Vec3<T> const& arm) {
  return vec(y[0], y[1], y[2]) + cross(vec(y[3], y[4], y[5]), arm);
}

template <class T>
MPMPBD_HD bool factor_end(RigidEnd<T> const& end, Mat3<T> const& A, Vec3<T> const& p, T gamma,
                          Mat<T, 7, 7>& m) {
  m = {};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) m(i, j) = end.matrix(i, j);
  m(6, 6) = T(-1);
  if (end.swaged) {
    for (int j = 0; j < 6; ++j) {
      Vec<T, 6> unit{};
      unit[j] = T(1);
      Vec<T, 6> const column = lift(end.arm, A * velocity_at(unit, end.arm));
      for (int i = 0; i < 6; ++i) m(i, j) += column[i];
    }
    Vec<T, 6> const link = lift(end.arm, p);
    for (int i = 0; i < 6; ++i) m(6, i) = link[i];
    m(6, 6) = -gamma;
  }
  return factor_ldlt(m);
}

// How the elimination of bead k changes the rows after it.
template <class T, bool bends> struct Carry {
  Mat3<T> A1{}, A2{}, U1{};  // taken from A_{k+1}, A_{k+2}, U_{k+1}
  Vec3<T> p{}, p_beyond{};   // link k as beads k+1 and k+2 feel it
  T gamma = T(1);            // and its own pivot
};

template <class T, bool bends>
MPMPBD_HD Carry<T, bends> eliminate(BeadFactor<T, bends> const& f, bool known, Link<T> const& link,
                                    Carry<T, bends> const& before) {
  Carry<T, bends> next;
  Mat3<T> F = f.inverse * f.U;  // V_k = ... - F V_{k+1}
  next.A1 = transpose(f.U) * F;
  next.gamma = link.compliance + dot(link.direction, f.inverse * link.direction);
  if constexpr (bends) {
    next.A1 += before.A2 - f.scale * outer(f.beyond, f.beyond);
    if (!known) {  // the left link moves this bead when the next one moves
      Vec3<T> const Uq = transpose(f.U) * f.edge;
      F += outer(f.edge, f.beyond);
      next.A1 += outer(Uq, f.beyond) + outer(f.beyond, Uq);
    }
    next.A2 = transpose(f.W) * f.inverse * f.W;
    next.U1 = transpose(F) * f.W;
    next.p_beyond = transpose(f.W) * (f.inverse * link.direction);
  }
  next.p = link.direction + transpose(F) * link.direction;
  return next;
}

// What elimination leaves of a stiff block is a small difference. Its unsymmetric part is rounding alone, and grows from
// bead to bead until it hides the mass of a light one.
template <class T> MPMPBD_HD Mat3<T> symmetric_part(Mat3<T> const& A) {
  return T(0.5) * (A + transpose(A));
}
}  // namespace detail

// The first beads of a chain that is solved several times, while only the others change.
template <class T, bool bends> struct ChainHead {
  int beads;                        // 0: all may change
  detail::Carry<T, bends> carry{};  // what their elimination takes from the rows after them
};

namespace detail {
// Beads begin ... end - 1, from what those before them leave; in the end what they leave themselves.
template <class T, bool bends>
MPMPBD_HD bool eliminate_beads(ChainSystem<T, bends> const& s,
                               ChainFactors<T, bends> const& factors, int begin, int end,
                               Carry<T, bends>& carry) {
  bool const swaged = s.end != nullptr && s.end->present && s.end->swaged;
  for (int k = begin; k < end; ++k) {
    BeadFactor<T, bends> f{};
    Mat3<T> const A = symmetric_part(s.blocks[k].A - carry.A1);
    f.U = s.blocks[k].U - carry.U1;
    if constexpr (bends) {
      f.W = s.blocks[k].W;
      f.beyond = carry.p_beyond;
    }
    if (swaged && k == s.beads - 1)
      return factor_end(*s.end, A, carry.p, carry.gamma, *factors.end);
    bool const ok = s.known[k] ? border_of_known(carry.p, carry.gamma, f)
                               : invert_bordered(A, carry.p, carry.gamma, f);
    if (!ok) return false;
    factors.beads[k] = f;
    if (k + 1 < s.beads) carry = eliminate(f, s.known[k], s.links[k], carry);
  }
  return true;
}
}  // namespace detail

// Eliminates the matrix again after its head, which is as it was.
template <class T, bool bends>
MPMPBD_HD bool refactor_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                              ChainHead<T, bends> const& head) {
  detail::Carry<T, bends> carry = head.carry;
  if (!detail::eliminate_beads(s, factors, head.beads, s.beads, carry)) return false;
  bool const alone = s.end != nullptr && s.end->present && !(s.end->swaged && s.beads > 0);
  return !alone || detail::factor_end(*s.end, Mat3<T>{}, Vec3<T>{}, T(1), *factors.end);
}
// Eliminates the matrix. Returns false when it is singular. In float, with k = dt^2 EI / (l^3 m) of a thread that
// bends, velocities of its light free ends are off by some k^2 / 1e8.
template <class T, bool bends>
MPMPBD_HD bool factor_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                            ChainHead<T, bends>& head) {
  head.carry = {};
  return detail::eliminate_beads(s, factors, 0, head.beads, head.carry) &&
         refactor_chain(s, factors, head);
}
template <class T, bool bends>
MPMPBD_HD bool factor_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors) {
  ChainHead<T, bends> whole{0};
  return factor_chain(s, factors, whole);
}

namespace detail {

// Bead k of the forward pass: what its own right-hand side leaves in the rows after it.
template <class T, bool bends>
MPMPBD_HD void reduce_bead(ChainSystem<T, bends> const& s, BeadFactor<T, bends> const f, int k,
                           Vec3<T>* r, T* g) {
  T const rho = k > 0 ? g[k - 1] : T(0);
  Vec3<T> const free = s.known[k] ? r[k] : f.inverse * r[k] + rho * f.edge;
  g[k] += dot(s.links[k].direction, free);
  if (!s.known[k + 1]) r[k + 1] -= transpose(f.U) * free;
  if constexpr (bends) {
    T const impulse = dot(f.edge, r[k]) - f.scale * rho;
    if (!s.known[k + 1]) r[k + 1] -= impulse * f.beyond;
    if (k + 2 < s.beads && !s.known[k + 2]) r[k + 2] -= transpose(f.W) * free;
  }
}

// Bead k of the backward pass: its velocity, and the impulse of the link on its left.
template <class T, bool bends>
MPMPBD_HD void resolve_bead(ChainSystem<T, bends> const& s, BeadFactor<T, bends> const f, int k,
                            Vec3<T>* r, T* g) {
  T rho = k > 0 ? g[k - 1] : T(0);
  Vec3<T> b = r[k];
  if (k + 1 < s.beads) {
    if (!s.known[k]) b += g[k] * s.links[k].direction - f.U * r[k + 1];
    if constexpr (bends) {
      rho -= dot(f.beyond, r[k + 1]);
      if (!s.known[k] && k + 2 < s.beads) b -= f.W * r[k + 2];
    }
  }
  if (k > 0) g[k - 1] = dot(f.edge, b) - f.scale * rho;
  if (!s.known[k]) r[k] = f.inverse * b + rho * f.edge;
}

// The rigid body, and with it the swaged bead and the link that ends there.
template <class T, bool bends>
MPMPBD_HD void resolve_end(ChainSystem<T, bends> const& s, Mat<T, 7, 7> const& factor, Vec3<T>* r,
                           T* g, Vec<T, 6>& y) {
  int const last = s.beads - 1;
  Vec<T, 7> x{};
  for (int i = 0; i < 6; ++i) x[i] = y[i];
  if (s.end->swaged) {
    Vec<T, 6> const on_bead = lift(s.end->arm, r[last]);
    for (int i = 0; i < 6; ++i) x[i] += on_bead[i];
    if (last > 0) x[6] = g[last - 1];
  }
  solve_ldlt(factor, x);
  for (int i = 0; i < 6; ++i) y[i] = x[i];
  if (!s.end->swaged) return;
  r[last] = velocity_at(y, s.end->arm);
  if (last > 0) g[last - 1] = x[6];
}

}  // namespace detail

// The two passes of a solution with the factors of factor_chain, over some of the beads. In: r = right-hand side (velocity
// where known), g per link, y = right-hand side of the rigid body. Out: r = velocities, g = link impulses,
// y = body velocity, spin.
//
// Up the chain: beads begin ... end - 1 hand on what their right-hand sides leave.
template <class T, bool bends>
MPMPBD_HD void reduce_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                            int begin, int end, Vec3<T>* r, T* g) {
  for (int k = begin; k < min(end, s.beads - 1); ++k)
    detail::reduce_bead(s, factors.beads[k], k, r, g);
}
// And down: the rigid body and the beads from the last one to `first`.
template <class T, bool bends>
MPMPBD_HD void resolve_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                             int first, Vec3<T>* r, T* g, Vec<T, 6>* y) {
  bool const has_end = s.end != nullptr && s.end->present;
  if (has_end) detail::resolve_end(s, *factors.end, r, g, *y);
  for (int k = s.beads - (has_end && s.end->swaged ? 2 : 1); k >= first; --k)
    detail::resolve_bead(s, factors.beads[k], k, r, g);
}
// The beads before those.
template <class T, bool bends>
MPMPBD_HD void resolve_head(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                            int first, Vec3<T>* r, T* g) {
  for (int k = first - 1; k >= 0; --k) detail::resolve_bead(s, factors.beads[k], k, r, g);
}

// All of it at once.
template <class T, bool bends>
MPMPBD_HD void solve_chain(ChainSystem<T, bends> const& s, ChainFactors<T, bends> const& factors,
                           Vec3<T>* r, T* g, Vec<T, 6>* y = nullptr) {
  reduce_chain(s, factors, 0, s.beads, r, g);
  resolve_chain(s, factors, 0, r, g, y);
}

}  // namespace mpmpbd
