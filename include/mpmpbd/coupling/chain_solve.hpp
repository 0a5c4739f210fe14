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

// Four numbers that a device loads at once: three of a bead and one of the link on its left. Of unknowns (V_k [m/s],
// lambda_{k-1} [N s]), of right-hand sides (r_k [N s], g_{k-1} [m/s]), of a matrix ([kg], and directions and 1/kg in a link's
// row).
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

// The rows of (V_k, lambda_{k-1}), by columns: the pivot [A p; p^T -c], p the direction of the left link, and what is ahead:
// [U; 0] of V_{k+1}, [-n; 0] of lambda_k and, where the thread bends, [W; 0] of V_{k+2}. The first bead has no left link;
// c = 1 stands in.
template <class T, bool bends> struct BeadRows {
  static constexpr int columns_ahead = bends ? 7 : 4;
  static constexpr int size = 4 + columns_ahead;
  Column<T> columns[size];

  MPMPBD_HD Column<T> const* ahead() const { return columns + 4; }

  // Of a bead between two links. Blocks A, U and W are 0.
  MPMPBD_HD static BeadRows between(Link<T> const& left, Link<T> const& right) {
    BeadRows rows{};
    for (int i = 0; i < 3; ++i) rows.columns[i][3] = left.direction[i];
    rows.columns[3] = Column<T>::of(left.direction, -left.compliance);
    rows.columns[7] = Column<T>::of(-right.direction, T(0));
    return rows;
  }
  MPMPBD_HD static constexpr Link<T> no_link() { return {Vec3<T>{}, T(1)}; }

  // Column j of blocks A and U.
  MPMPBD_HD Column<T>& A(int j) { return columns[j]; }
  MPMPBD_HD Column<T>& U(int j) { return columns[4 + j]; }
  MPMPBD_HD void add_to_A(Mat3<T> const& block) { add(columns, block); }
  MPMPBD_HD void add_to_U(Mat3<T> const& block) { add(columns + 4, block); }
  MPMPBD_HD void add_to_W(Mat3<T> const& block) requires bends { add(columns + 8, block); }

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
  // count; of the rigid body: impulse and its moment [N s, N m s], then velocity and spin [m/s, rad/s]. Null without one.
  Vec<T, 6>* bodies;
};

// What elimination leaves of a bead: Y of the columns ahead, and of the right-hand sides.
template <class T, bool bends> struct BeadFactor {
  Column<T> columns[BeadRows<T, bends>::columns_ahead + most_sides];
};

// Between two beads: columns of the next bead's rows (its pivot, then U, then right-hand sides), and what elimination adds to
// those of the bead beyond (A, and right-hand sides). While elimination goes on, `next` is what is left of these columns; at the
// end of a head, whose next rows change, what is added to them.
template <class T, bool bends> struct ChainFront {
  Column<T> next[BeadRows<T, bends>::columns_ahead + most_sides];
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

template <class T> MPMPBD_HD constexpr Mat3<T> symmetric(T xx, T yx, T zx, T yy, T zy, T zz) {
  return {{xx, yx, zx, yx, yy, zy, zx, zy, zz}};
}

// Cofactors of a symmetric positive definite matrix of trace 1, and its determinant, by A = L D L^T: products of pivots.
// Differences of products of its entries, the usual way, can leave nothing of a small determinant in float (a light
// bead that leans on the tissue in one direction).
template <class T> struct Cofactors {
  Mat3<T> matrix;
  T determinant;
};
template <class T> MPMPBD_HD Cofactors<T> definite_cofactors(Mat3<T> const& A) {
  T const least = epsilon<T>;
  T const d1 = max(A(0, 0), least), per_d1 = reciprocal(d1);
  T const l21 = A(1, 0) * per_d1, l31 = A(2, 0) * per_d1;
  T const d2 = max(multiply_add(-l21, A(1, 0), A(1, 1)), least);
  T const l32 = multiply_add(-l31, A(1, 0), A(2, 1)) * reciprocal(d2);
  T const rest = multiply_add(-l31, A(2, 0), A(2, 2));
  T const d3 = max(multiply_add(-(l32 * l32), d2, rest), least);
  // Rows of L^-1: (1, 0, 0), (-l21, 1, 0), (m31, -l32, 1).
  T const m31 = multiply_add(l21, l32, -l31);
  T const d12 = d1 * d2, d13 = d1 * d3, d23 = d2 * d3;
  T const xx = multiply_add(d12 * m31, m31, multiply_add(d13 * l21, l21, d23));
  T const yx = multiply_add(-(d12 * m31), l32, -d13 * l21);
  return {symmetric(xx, yx, d12 * m31, multiply_add(d12 * l32, l32, d13), -d12 * l32, d12),
          d12 * d3};
}

// A pivot [A p; p^T -gamma], gamma >= 0, ready to be solved without subtraction: with C the cofactors of A,
//   (A + p p^T / gamma)^-1 = (gamma C + [p]x A [p]x^T) / (gamma det A + p . C p).
// It stays exact for gamma -> 0 and for a tiny A. A is scaled to trace 1, so that float does not underflow.
template <class T> struct Pivot {
  Mat3<T> A, C;
  Vec3<T> p, edge;
  T gamma, factor, scale;
  bool regular;

  // What elimination leaves of a stiff block is a small difference. Its unsymmetric part is rounding alone, and grows
  // from bead to bead until it hides the mass of a light one.
  MPMPBD_HD static Mat3<T> symmetric_part(Column<T> const* columns) {
    Column<T> const x = columns[0], y = columns[1], z = columns[2];
    return symmetric(x[0], T(0.5) * (x[1] + y[0]), T(0.5) * (x[2] + z[0]), y[1],
                     T(0.5) * (y[2] + z[1]), z[2]);
  }

  MPMPBD_HD static Pivot of(Column<T> const* columns) {
    Pivot f;
    f.A = symmetric_part(columns);
    Column<T> const left = columns[3];
    f.p = left.bead();
    T const size = trace(f.A), per_size = reciprocal(size);
    f.A *= per_size;
    f.gamma = -left.link() * size;
    auto const [C, det] = definite_cofactors(f.A);
    f.C = C;
    Vec3<T> const Cp = C * f.p;
    T const whole = multiply_add(f.gamma, det, dot(f.p, Cp)), per_whole = reciprocal(whole);
    f.factor = per_whole * per_size;
    f.edge = per_whole * Cp;
    f.scale = det * per_whole * size;
    f.regular = size > T(0) && whole > square(epsilon<T>) * (f.gamma + dot(f.p, f.p)) &&
                is_finite(f.factor) && is_finite(f.scale);
    return f;
  }
  // Of a known bead: its left link alone remains. Not regular: an inextensible link between two known velocities.
  MPMPBD_HD static Pivot of_link(Column<T> const& left) {
    Pivot f{};
    T const gamma = -left.link();
    f.scale = T(1) / gamma;
    f.edge = f.scale * left.bead();
    f.regular = gamma > T(0);
    return f;
  }

  // V and lambda.
  MPMPBD_HD Column<T> solve(Column<T> const& b) const {
    Vec3<T> const along = cross(p, A * cross(b.bead(), p));
    Vec3<T> const V = factor * add_product(along, gamma, C * b.bead());
    return Column<T>::of(add_product(V, b.link(), edge),
                         multiply_add(-scale, b.link(), dot(edge, b.bead())));
  }
  // Of a known bead: `V` is its velocity, or 0 in a column of the matrix.
  MPMPBD_HD Column<T> solve_known(Vec3<T> const& V, T link) const {
    return Column<T>::of(V, multiply_add(-scale, link, dot(edge, V)));
  }
};

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

// The elimination by a group of lanes. Column c is a lane's, wherever it stands: of V_{k+1}, lambda_k, V_{k+2} and the sides
// in the rows of bead k, and what elimination adds to it, which belongs to the next bead's pivot, U and sides.
template <class Group_, class T, bool bends> struct Elimination {
  using Rows = BeadRows<T, bends>;
  using Front = ChainFront<T, bends>;
  static constexpr int ahead = Rows::columns_ahead;

  Group_ const& group;
  ChainSystem<T, bends> const& s;
  ChainSides<T> const& sides;
  ChainWork<T, bends> const& work;

  MPMPBD_HD int columns() const { return ahead + sides.count; }
  MPMPBD_HD bool ends_on_body() const {
    return s.end != nullptr && s.end->present && s.end->swaged && s.beads > 0;
  }

  // Beads begin ... end - 1, after those that leave `before` (null: none). Leaves its own in `after`, unless that is null.
  MPMPBD_HD bool run(int begin, int end, Front const* before, Front* after) const {
    if (begin == end) return true;
    int const last = end == s.beads && ends_on_body() ? end - 1 : end;
    enter(begin, before);
    for (int k = begin; k < last; ++k) {
      Front const& front = work.front[k % 2];
      bool const known = s.known[k];
      auto const pivot = known ? Pivot<T>::of_link(front.next[3]) : Pivot<T>::of(front.next);
      if (!pivot.regular) return false;
      if (k + 1 == end && after != nullptr)
        eliminate<true>(k, known, pivot, front, *after);
      else
        eliminate<false>(k, known, pivot, front, work.front[(k + 1) % 2]);
      group.sync();
    }
    return last == end || solve_end(work.front[last % 2].next);
  }

  // A rigid body; and with it the swaged bead and the link that ends there, what is left of whose rows is given.
  MPMPBD_HD bool solve_end(Column<T> const* rest) const {
    RigidEnd<T> const& body = *s.end;
    group.one([&] {
      work.end->regular = factor_end(body, Pivot<T>::symmetric_part(rest), rest[3].bead(),
                                     -rest[3].link(), work.end->matrix);
    });
    group.sync();
    if (!work.end->regular) return false;
    group.each(sides.count, [&](int j) {
      Vec<T, 6>& y = sides.bodies[j];
      Column<T> const& b = rest[ahead + j];
      Vec<T, 7> x{};
      Vec<T, 6> const on_bead = body.swaged ? lift(body.arm, b.bead()) : Vec<T, 6>{};
      for (int i = 0; i < 6; ++i) x[i] = y[i] + on_bead[i];
      if (body.swaged) x[6] = b.link();
      solve_ldlt(work.end->matrix, x);
      for (int i = 0; i < 6; ++i) y[i] = x[i];
      if (body.swaged)
        sides.columns[j * s.beads + s.beads - 1] = Column<T>::of(velocity_at(y, body.arm), x[6]);
    });
    group.sync();
    return true;
  }

 private:
  // Columns of the bead after next have fill: of A, and right-hand sides.
  MPMPBD_HD static constexpr bool has_beyond(int c) { return c < 3 || c >= ahead; }

  // What is left of column c in the rows of bead k, when elimination has added so much. A known velocity stays.
  MPMPBD_HD Column<T> left_of(int c, int k, Vec<T, 4> added) const {
    bool const is_side = c >= ahead;
    Column<T> const whole =
        is_side ? sides.columns[(c - ahead) * s.beads + k] : s.rows[k].columns[c];
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
    group.sync();
  }

  // Leaves of the next bead's rows what is left of them, or, with `added_alone`, what is added to them.
  template <bool added_alone>
  MPMPBD_HD void eliminate(int k, bool known, Pivot<T> const& pivot, Front const& front,
                           Front& after) const {
    Column<T> const* rows = s.rows[k].ahead();
    Column<T> X[ahead];
    for (int a = 0; a < ahead; ++a) X[a] = bends && a < 3 ? front.next[4 + a] : rows[a];
    group.each(columns(), [&](int c) {
      bool const from_front = c >= ahead || (bends && c < 3);
      Column<T> const mine = from_front ? front.next[c < 3 ? 4 + c : c] : rows[c];
      auto const Y = known ? pivot.solve_known(c < ahead ? Vec3<T>{} : mine.bead(), mine.link())
                           : pivot.solve(mine);
      work.factors[k].columns[c] = Y;
      Vec<T, 4> added;
      for (int a = 0; a < 4; ++a) added[a] = -dot(X[a], Y);
      if constexpr (bends) {
        if (has_beyond(c)) added += front.beyond[c];
        if (c >= 4)
          after.beyond[c < ahead ? c - 4 : c] =
              Column<T>::of(-vec(dot(X[4].bead(), Y.bead()), dot(X[5].bead(), Y.bead()),
                                 dot(X[6].bead(), Y.bead())),
                            T(0));
      }
      if constexpr (added_alone)
        after.next[c] = {added};
      else if (k + 1 < s.beads)
        after.next[c] = left_of(c, k + 1, added);
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
  Column<T> const no_rows[BeadRows<T, bends>::columns_ahead + most_sides] = {};
  return !alone || all.solve_end(no_rows);
}

namespace detail {
// a - s b. By value, so that a device loads b at once.
template <class T> MPMPBD_HD Column<T> minus_times(Column<T> const& a, T s, Column<T> const b) {
  return {add_product(a, -s, b)};
}
}  // namespace detail

// Solutions of beads end - 1 down to `begin`, when those after them stand there already.
template <class Group_, class T, bool bends>
MPMPBD_HD void substitute(Group_ const& group, ChainSystem<T, bends> const& s,
                          ChainSides<T> const& sides, ChainWork<T, bends> const& work, int begin,
                          int end) {
  constexpr int ahead = BeadRows<T, bends>::columns_ahead;
  group.each(sides.count, [&](int j) {
    Column<T>* const x = sides.columns + j * s.beads;
    Column<T> next = end < s.beads ? x[end] : Column<T>{};
    Column<T> beyond = end + 1 < s.beads ? x[end + 1] : Column<T>{};
    for (int k = end - 1; k >= begin; --k) {
      Column<T> const* Y = work.factors[k].columns;
      Column<T> mine = Y[ahead + j];
      if constexpr (bends)
        for (int a = 0; a < 3; ++a) mine = detail::minus_times(mine, beyond[a], Y[4 + a]);
      for (int a = 0; a < 4; ++a) mine = detail::minus_times(mine, next[a], Y[a]);
      beyond = next;
      next = x[k] = mine;
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
