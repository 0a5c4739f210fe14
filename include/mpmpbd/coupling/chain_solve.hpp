// Direct solve of a chain of beads in mixed form: new bead velocities V_k and link impulses lambda_k.
//
//   A_k V_k + U_k V_{k+1} + W_k V_{k+2} + (transposed terms of k-1, k-2)
//                                       - n_k lambda_k + n_{k-1} lambda_{k-1} = r_k
//   n_k . (V_{k+1} - V_k) - c_k lambda_k = g_k
//
// The mixed form keeps a stiff thread accurate in float: its stiffness enters as the compliance c_k,
// not as a large number added to masses, and lambda is an unknown, never a small difference of lengths.
//
// One pass up the chain eliminates bead k together with the link on its left, a pivot P of the four unknowns
// w_k = (V_k, lambda_{k-1}). That order works for inextensible links (c = 0) behind a bead of known velocity too, where a
// link has no other pivot. Unknowns that share an equation with them are ahead: V_{k+1}, lambda_k and, where the
// thread bends, V_{k+2}. With X their columns in the rows of the pivot, elimination leaves Y = P^-1 X and takes X^T Y from
// the rows ahead. Right-hand sides are columns like the others, and every column is a lane's (multifrontal
// elimination, Duff and Reid 1983): on a device a warp solves a chain, with one barrier per bead.
#pragma once

#include <mpmpbd/coupling/dense_solve.hpp>
#include <mpmpbd/coupling/team.hpp>

namespace mpmpbd {

// Four numbers that a device loads at once: three of a bead and one of the link on its left.
template <class T> struct alignas(16) Column : Vec<T, 4> {
  MPMPBD_HD static constexpr Column of(Vec3<T> const& bead, T link) {
    return {{{bead[0], bead[1], bead[2], link}}};
  }
  MPMPBD_HD constexpr Vec3<T> bead() const { return vec(this->m[0], this->m[1], this->m[2]); }
  MPMPBD_HD constexpr T link() const { return this->m[3]; }
};

// The link from bead k to k+1. A gap between two threads has direction 0, compliance 1, and U = W = 0.
template <class T> struct Link {
  Vec3<T> direction;  // n
  T compliance;       // c [1/kg]; 0: inextensible
};

// The rows of (V_k, lambda_{k-1}), by columns: the pivot [A p; p^T -c], p the direction of the left link, and what is ahead.
// The first bead has no left link; c = 1 stands in. W exists only where the thread bends.
template <class T, bool bends> struct BeadRows {
  static constexpr int ahead_columns = bends ? 7 : 4;
  Column<T> pivot[4];
  Column<T> ahead[ahead_columns];  // [U; 0] of V_{k+1}, [-n; 0] of lambda_k, [W; 0] of V_{k+2}

  // Of a bead between two links. Blocks A, U and W are 0.
  MPMPBD_HD static BeadRows between(Link<T> const& left, Link<T> const& right) {
    BeadRows rows{};
    for (int i = 0; i < 3; ++i) rows.pivot[i][3] = left.direction[i];
    rows.pivot[3] = Column<T>::of(left.direction, -left.compliance);
    rows.ahead[3] = Column<T>::of(-right.direction, T(0));
    return rows;
  }
  MPMPBD_HD static constexpr Link<T> no_link() { return {Vec3<T>{}, T(1)}; }

  MPMPBD_HD void add_to_A(Mat3<T> const& block) { add(pivot, block); }
  MPMPBD_HD void add_to_U(Mat3<T> const& block) { add(ahead, block); }
  MPMPBD_HD void add_to_W(Mat3<T> const& block)
    requires bends
  {
    add(ahead + 4, block);
  }

 private:
  MPMPBD_HD static void add(Column<T>* columns, Mat3<T> const& block) {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) columns[j][i] += block(i, j);
  }
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
  BeadRows<T, bends> const* rows;  // beads
  bool const* known;               // beads; a known velocity leaves the system, its row drops
  RigidEnd<T> const* end;          // may be null
};

// Right-hand sides, later solutions, all of the same matrix. Side j has its columns (r_k, g_{k-1}) from j * beads on: velocity
// instead of r where that is known. A solution stands there as (V_k, lambda_{k-1}).
inline constexpr int most_sides = 2;
template <class T> struct ChainSides {
  int count;
  Column<T>* columns;  // count * beads
  Vec<T, 6>* bodies;   // count; of the rigid body: force, then velocity and spin. Null without one
};

// What elimination leaves of a bead: Y of the columns ahead, and of the right-hand sides.
template <class T, bool bends> struct BeadFactor {
  Column<T> columns[BeadRows<T, bends>::ahead_columns + most_sides];
};

// What elimination adds to the columns of the next bead's rows (its pivot, then U, then right-hand sides), and of those of
// the bead beyond (A, and right-hand sides).
template <class T, bool bends> struct ChainFront {
  Column<T> next[BeadRows<T, bends>::ahead_columns + most_sides];
  Column<T> beyond[bends ? 7 + most_sides : 1];
};

// Rigid body and the link that ends on it.
template <class T> struct EndFactor {
  Mat<T, 7, 7> matrix;
  bool regular;
};

// Work memory of a solution. Factors stay: of the head of a chain, and for another substitution.
template <class T, bool bends> struct ChainWork {
  BeadFactor<T, bends>* factors;  // beads
  ChainFront<T, bends>* front;    // 2
  EndFactor<T>* end;              // may be null without a rigid end
};

namespace detail {

// Inverse of a pivot [A p; p^T -gamma]: [inverse edge; edge^T -scale].
template <class T> struct PivotInverse {
  Mat3<T> inverse;
  Vec3<T> edge;
  T scale;
  bool regular;
};

// Cofactors of a symmetric positive definite matrix, and its determinant, by A = L D L^T: products of pivots.
// Differences of products of its entries, the usual way, can leave nothing of a small determinant in float (a light
// bead that leans on the tissue in one direction).
template <class T> struct Cofactors {
  Mat3<T> matrix;
  T determinant;
};
template <class T> MPMPBD_HD constexpr Mat3<T> symmetric(T xx, T yx, T zx, T yy, T zy, T zz) {
  return {{xx, yx, zx, yx, yy, zy, zx, zy, zz}};
}
template <class T> MPMPBD_HD Cofactors<T> definite_cofactors(Mat3<T> const& A) {
  T const least = epsilon<T> * trace(A);
  T const d1 = max(A(0, 0), least), per_d1 = T(1) / d1;
  T const l21 = A(1, 0) * per_d1, l31 = A(2, 0) * per_d1;
  T const d2 = max(A(1, 1) - l21 * A(1, 0), least), l32 = (A(2, 1) - l31 * A(1, 0)) / d2;
  T const d3 = max(A(2, 2) - l31 * A(2, 0) - l32 * l32 * d2, least);
  T const m31 = l21 * l32 - l31;  // rows of L^-1: (1, 0, 0), (-l21, 1, 0), (m31, -l32, 1)
  T const d12 = d1 * d2, d13 = d1 * d3, d23 = d2 * d3;
  return {symmetric(d23 + d13 * l21 * l21 + d12 * m31 * m31, -d13 * l21 - d12 * m31 * l32,
                    d12 * m31, d13 + d12 * l32 * l32, -d12 * l32, d12),
          d12 * d3};
}

// [p]x A [p]x^T of a symmetric A.
template <class T> MPMPBD_HD Mat3<T> crossed(Vec3<T> const& p, Mat3<T> const& A) {
  Vec3<T> const x = cross(p, vec(A(0, 0), A(1, 0), A(2, 0))),
                y = cross(p, vec(A(0, 1), A(1, 1), A(2, 1))),
                z = cross(p, vec(A(0, 2), A(1, 2), A(2, 2)));
  Vec3<T> const first = cross(p, vec(x[0], y[0], z[0])), second = cross(p, vec(x[1], y[1], z[1]));
  return symmetric(first[0], first[1], first[2], second[1], second[2],
                   p[0] * y[2] - p[1] * x[2]);
}

// Without subtraction, gamma >= 0: with C the cofactors of A,
//   (A + p p^T / gamma)^-1 = (gamma C + [p]x A [p]x^T) / (gamma det A + p . C p).
// It stays exact for gamma -> 0 and for a tiny A. A is scaled to trace 1, so that float does not underflow.
template <class T>
MPMPBD_HD PivotInverse<T> invert_pivot(Mat3<T> A, Vec3<T> const& p, T gamma) {
  T const size = trace(A), per_size = T(1) / size;
  A *= per_size;
  gamma *= size;
  auto const [C, det] = definite_cofactors(A);
  Vec3<T> const Cp = C * p;
  T const denominator = gamma * det + dot(p, Cp), per_denominator = T(1) / denominator;
  PivotInverse<T> f;
  f.inverse = per_denominator * per_size * (gamma * C + crossed(p, A));
  f.edge = per_denominator * Cp;
  f.scale = det * per_denominator * size;
  f.regular = size > T(0) && is_finite(size) &&
              denominator > square(epsilon<T>) * (gamma + dot(p, p)) &&
              is_finite(trace(f.inverse) + f.scale);
  return f;
}

// A known bead: its left link alone remains. Not regular: an inextensible link between two known velocities.
template <class T> MPMPBD_HD PivotInverse<T> invert_link(Vec3<T> const& p, T gamma) {
  T const scale = T(1) / gamma;
  return {Mat3<T>{}, scale * p, scale, gamma > T(0)};
}

// What elimination leaves of a stiff block is a small difference. Its unsymmetric part is rounding alone, and grows from
// bead to bead until it hides the mass of a light one.
template <class T> MPMPBD_HD Mat3<T> symmetric_part(Column<T> const (&pivot)[4]) {
  return symmetric(pivot[0][0], T(0.5) * (pivot[0][1] + pivot[1][0]),
                   T(0.5) * (pivot[0][2] + pivot[2][0]), pivot[1][1],
                   T(0.5) * (pivot[1][2] + pivot[2][1]), pivot[2][2]);
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

// The elimination by a group of lanes.
template <class Group_, class T, bool bends> struct Elimination {
  using Rows = BeadRows<T, bends>;
  using Front = ChainFront<T, bends>;
  static constexpr int ahead = Rows::ahead_columns;

  Group_ const& group;
  ChainSystem<T, bends> const& s;
  ChainSides<T> const& sides;
  ChainWork<T, bends> const& work;

  MPMPBD_HD int columns() const { return ahead + sides.count; }
  MPMPBD_HD bool ends_on_body(int k) const {
    return s.end != nullptr && s.end->present && s.end->swaged && k + 1 == s.beads;
  }

  // Beads begin ... end - 1, after those that leave `before` (null: none). Leaves its own in `after` if there is a bead to
  // take it.
  MPMPBD_HD bool run(int begin, int end, Front const* before, Front* after) const {
    enter(begin, before);
    for (int k = begin; k < end; ++k) {
      group.sync();
      Front const& front = work.front[k % 2];
      Column<T> const pivot[4] = {front.next[0], front.next[1], front.next[2], front.next[3]};
      if (ends_on_body(k)) return solve_end(pivot, front.next + ahead);
      auto const inverse = s.known[k] ? invert_link(pivot[3].bead(), -pivot[3].link())
                                      : invert_pivot(symmetric_part(pivot), pivot[3].bead(),
                                                     -pivot[3].link());
      if (!inverse.regular) return false;
      bool const is_last = k + 1 == end;
      eliminate(k, inverse, front, is_last && after != nullptr ? *after : work.front[(k + 1) % 2],
                !is_last);
    }
    group.sync();
    return true;
  }

  // A rigid body; and with it the swaged bead and the link that ends there, what is left of whose rows is given.
  MPMPBD_HD bool solve_end(Column<T> const (&pivot)[4], Column<T> const* rest) const {
    RigidEnd<T> const& body = *s.end;
    group.one([&] {
      work.end->regular = factor_end(body, symmetric_part(pivot), pivot[3].bead(),
                                     -pivot[3].link(), work.end->matrix);
    });
    group.sync();
    if (!work.end->regular) return false;
    group.each(sides.count, [&](int j) {
      Vec<T, 6>& y = sides.bodies[j];
      Vec<T, 7> x{};
      Vec<T, 6> const on_bead =
          body.swaged ? lift(body.arm, rest[j].bead()) : Vec<T, 6>{};
      for (int i = 0; i < 6; ++i) x[i] = y[i] + on_bead[i];
      if (body.swaged) x[6] = rest[j].link();
      solve_ldlt(work.end->matrix, x);
      for (int i = 0; i < 6; ++i) y[i] = x[i];
      if (body.swaged)
        sides.columns[j * s.beads + s.beads - 1] = Column<T>::of(velocity_at(y, body.arm), x[6]);
    });
    group.sync();
    return true;
  }

 private:
  MPMPBD_HD Column<T> const& side(int column, int k) const {
    return sides.columns[(column - ahead) * s.beads + k];
  }
  // Column c of what is left of the rows of bead k, when elimination has added so much. A known velocity stays.
  MPMPBD_HD Column<T> left_of(int c, int k, Vec<T, 4> added) const {
    Rows const& rows = s.rows[k];
    bool const is_side = c >= ahead;
    Column<T> const& whole = is_side ? side(c, k) : (c < 4 ? rows.pivot[c] : rows.ahead[c - 4]);
    if (is_side && s.known[k]) added = Column<T>::of(Vec3<T>{}, added[3]);
    return {whole + added};
  }
  MPMPBD_HD void enter(int k, Front const* before) const {
    Front& front = work.front[k % 2];
    group.sync();
    group.each(columns(), [&](int c) {
      front.next[c] = left_of(c, k, before != nullptr ? before->next[c] : Column<T>{});
      if constexpr (bends)
        if (has_beyond(c)) front.beyond[c] = before != nullptr ? before->beyond[c] : Column<T>{};
    });
  }
  // Columns of the bead after next have fill: of A, and right-hand sides.
  MPMPBD_HD static constexpr bool has_beyond(int c) { return c < 3 || c >= ahead; }

  // Every lane eliminates from its column.
  MPMPBD_HD void eliminate(int k, PivotInverse<T> const& inverse, Front const& front, Front& after,
                           bool goes_on) const {
    Rows const& rows = s.rows[k];
    bool const known = s.known[k];
    Column<T> X[ahead];
    for (int a = 0; a < ahead; ++a) X[a] = bends && a < 3 ? front.next[4 + a] : rows.ahead[a];
    group.each(columns(), [&](int c) {
      Column<T> const* mine = c < ahead ? rows.ahead + c : front.next + c;
      if (bends && c < 3) mine = front.next + 4 + c;
      Vec3<T> const bead = known && c < ahead ? Vec3<T>{} : mine->bead();
      T const link = mine->link();
      auto const Y = Column<T>::of(known ? bead : inverse.inverse * bead + link * inverse.edge,
                                   dot(inverse.edge, bead) - inverse.scale * link);
      work.factors[k].columns[c] = Y;
      Vec<T, 4> added;
      for (int a = 0; a < 4; ++a) added[a] = -dot(X[a], Y);
      if constexpr (bends) {
        if (has_beyond(c)) added += front.beyond[c];
        int const of = c < ahead ? c - 4 : c;
        if (of >= 0)
          after.beyond[of] = Column<T>::of(
              -vec(dot(X[4].bead(), Y.bead()), dot(X[5].bead(), Y.bead()), dot(X[6].bead(), Y.bead())),
              T(0));
      }
      if (k + 1 < s.beads) after.next[c] = goes_on ? left_of(c, k + 1, added) : Column<T>{added};
    });
  }
};

}  // namespace detail

// The first beads of a chain that is solved several times, while only the others change.
template <class T, bool bends> struct ChainHead {
  int beads;                   // 0: all may change
  ChainFront<T, bends> front;  // what their elimination adds to the rows after them
};

// Eliminates the beads of the head, which leaves its front.
template <class Group_, class T, bool bends>
MPMPBD_HD bool eliminate_head(Group_ const& group, ChainSystem<T, bends> const& s,
                              ChainSides<T> const& sides, ChainWork<T, bends> const& work,
                              ChainHead<T, bends>& head) {
  return detail::Elimination<Group_, T, bends>{group, s, sides, work}.run(0, head.beads, nullptr,
                                                                          &head.front);
}
// And those after it, with the rigid body, whose solution is found already. Returns false when the matrix is singular. In
// float, with k = dt^2 EI / (l^3 m) of a thread that bends, velocities of its light free ends are off by some k^2 / 1e8.
template <class Group_, class T, bool bends>
MPMPBD_HD bool eliminate_rest(Group_ const& group, ChainSystem<T, bends> const& s,
                              ChainSides<T> const& sides, ChainWork<T, bends> const& work,
                              ChainHead<T, bends> const& head) {
  detail::Elimination<Group_, T, bends> const all{group, s, sides, work};
  ChainFront<T, bends>* const none = nullptr;
  if (!all.run(head.beads, s.beads, head.beads > 0 ? &head.front : none, none)) return false;
  bool const alone = s.end != nullptr && s.end->present && !(s.end->swaged && s.beads > 0);
  Column<T> const no_rows[4] = {};
  return !alone || all.solve_end(no_rows, nullptr);
}

// Solutions of beads end - 1 down to `begin`, when those after them stand there already.
template <class Group_, class T, bool bends>
MPMPBD_HD void substitute(Group_ const& group, ChainSystem<T, bends> const& s,
                          ChainSides<T> const& sides, ChainWork<T, bends> const& work, int begin,
                          int end) {
  constexpr int ahead = BeadRows<T, bends>::ahead_columns;
  group.each(sides.count, [&](int j) {
    Column<T>* const x = sides.columns + j * s.beads;
    Column<T> next = end < s.beads ? x[end] : Column<T>{};
    Column<T> beyond = end + 1 < s.beads ? x[end + 1] : Column<T>{};
    for (int k = end - 1; k >= begin; --k) {
      Column<T> const* Y = work.factors[k].columns;
      Vec<T, 4> mine = Y[ahead + j];
      if constexpr (bends)
        for (int a = 0; a < 3; ++a) mine -= beyond[a] * Y[4 + a];
      for (int a = 0; a < 4; ++a) mine -= next[a] * Y[a];
      beyond = next;
      next = x[k] = Column<T>{mine};
    }
  });
  group.sync();
}
// Of the beads from `begin` on, after eliminate_rest.
template <class Group_, class T, bool bends>
MPMPBD_HD void substitute_rest(Group_ const& group, ChainSystem<T, bends> const& s,
                               ChainSides<T> const& sides, ChainWork<T, bends> const& work,
                               int begin) {
  bool const on_body = s.end != nullptr && s.end->present && s.end->swaged;
  substitute(group, s, sides, work, begin, on_body ? s.beads - 1 : s.beads);
}

// All of it at once. Returns false when the matrix is singular.
template <class Group_, class T, bool bends>
MPMPBD_HD bool solve_chain(Group_ const& group, ChainSystem<T, bends> const& s,
                           ChainSides<T> const& sides, ChainWork<T, bends> const& work) {
  ChainHead<T, bends> whole{};
  if (!eliminate_rest(group, s, sides, work, whole)) return false;
  substitute_rest(group, s, sides, work, 0);
  return true;
}

}  // namespace mpmpbd
