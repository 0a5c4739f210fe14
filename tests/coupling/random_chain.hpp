// Random chains for the tests of the chain solve: threads with tension, contact, bending, gaps, beads
// of known velocity and a rigid body at the end, and the same equations as one dense matrix.
#pragma once

#include <random>
#include <vector>

#include <Eigen/Dense>

#include <mpmpbd/coupling/chain_solve.hpp>

namespace test {

// Blocks of a bead's equations: its own, and with the next bead and the next but one.
template <class T> struct Blocks { mpmpbd::Mat3<T> A, U, W; };

template <class T, bool bends> struct RandomChain {
  using Rows = mpmpbd::BeadRows<T, bends>;
  std::vector<Blocks<T>> blocks;
  std::vector<mpmpbd::Link<T>> links;
  std::vector<char> known_bytes;
  std::vector<mpmpbd::Vec3<T>> r;
  std::vector<T> g;
  mpmpbd::RigidEnd<T> end{};
  mpmpbd::Vec<T, 6> y{};

  int beads() const { return static_cast<int>(blocks.size()); }
  bool const* known() const { return reinterpret_cast<bool const*>(known_bytes.data()); }
  std::vector<Rows> rows() const {
    std::vector<Rows> all;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      all.push_back(Rows::between(k > 0 ? links[k - 1] : Rows::no_link(),
                                  k + 1 < blocks.size() ? links[k] : Rows::no_link()));
      all.back().add_to_A(blocks[k].A);
      all.back().add_to_U(blocks[k].U);
      if constexpr (bends) all.back().add_to_W(blocks[k].W);
    }
    return all;
  }
};

// Velocities, link impulses and the motion of the rigid body.
template <class T> struct ChainSolution {
  bool regular;
  std::vector<mpmpbd::Vec3<T>> V;
  std::vector<T> lambda;
  mpmpbd::Vec<T, 6> y;
};

// A chain with the right-hand sides of one or two, all of the matrix of the first, and the memory to solve it.
template <class T, bool bends> class ChainRun {
 public:
  ChainRun(std::vector<RandomChain<T, bends>> const& sides, int beads_of_head)
      : chain_(sides.front()), rows_(chain_.rows()), factors_(rows_.size()) {
    for (auto const& side : sides) {
      for (std::size_t k = 0; k < rows_.size(); ++k)
        columns_.push_back(mpmpbd::Column<T>::of(side.r[k], k > 0 ? side.g[k - 1] : T(0)));
      bodies_.push_back(side.y);
    }
    head_.beads = beads_of_head;
  }

  // By all lanes of a group, with a head that is eliminated by itself. Returns whether the matrix is regular.
  template <class Group_> bool solve(Group_ const& group) {
    mpmpbd::ChainSystem<T, bends> const system{chain_.beads(), rows_.data(), chain_.known(),
                                               &chain_.end};
    mpmpbd::ChainSides<T> const all{static_cast<int>(bodies_.size()), columns_.data(),
                                    bodies_.data()};
    mpmpbd::ChainWork<T, bends> const work{factors_.data(), front_, &end_};
    if (!mpmpbd::eliminate_head(group, system, all, work, head_) ||
        !mpmpbd::eliminate_rest(group, system, all, work, head_))
      return false;
    mpmpbd::substitute_rest(group, system, all, work, head_.beads);
    mpmpbd::substitute(group, system, all, work, 0, head_.beads);
    return true;
  }
  std::vector<ChainSolution<T>> found(bool regular) const {
    auto const n = rows_.size();
    std::vector<ChainSolution<T>> all(bodies_.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
      all[j].regular = regular;
      all[j].y = bodies_[j];
      for (std::size_t k = 0; k < n; ++k) {
        all[j].V.push_back(columns_[j * n + k].bead());
        all[j].lambda.push_back(k + 1 < n ? columns_[j * n + k + 1].link() : T(0));
      }
    }
    return all;
  }

 private:
  RandomChain<T, bends> chain_;
  std::vector<mpmpbd::BeadRows<T, bends>> rows_;
  std::vector<mpmpbd::BeadFactor<T, bends>> factors_;
  std::vector<mpmpbd::Column<T>> columns_;
  std::vector<mpmpbd::Vec<T, 6>> bodies_;
  mpmpbd::ChainFront<T, bends> front_[2];
  mpmpbd::EndFactor<T> end_;
  mpmpbd::ChainHead<T, bends> head_{};
};
template <class T, bool bends>
std::vector<ChainSolution<T>> solve_all(std::vector<RandomChain<T, bends>> const& sides,
                                        int beads_of_head) {
  ChainRun<T, bends> run(sides, beads_of_head);
  return run.found(run.solve(mpmpbd::Solo{}));
}
template <class T, bool bends>
ChainSolution<T> solve(RandomChain<T, bends> const& c, int beads_of_head = 0) {
  return solve_all<T, bends>({c}, beads_of_head).front();
}

enum class Ends { free, body, swaged };

struct ChainOptions {
  int beads = 12;
  double mass_low = 1e-4, mass_high = 1e2;
  bool inextensible = false, straight = false, gaps = true, known = true;
  bool held_by_tissue = false;  // every segment sticks to tissue
  Ends ends = Ends::free;
};

template <class T, bool bends>
RandomChain<T, bends> random_chain(std::mt19937& random, ChainOptions const& o) {
  using mpmpbd::Mat3;
  using mpmpbd::Vec3;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  auto const log_uniform = [&](double a, double b) { return a * std::pow(b / a, unit(random)); };
  auto const arrow = [&] {
    return mpmpbd::vec<T>(T(normal(random)), T(normal(random)), T(normal(random)));
  };
  auto const n = static_cast<std::size_t>(o.beads);
  RandomChain<T, bends> c;
  c.blocks.resize(n);
  c.links.resize(n);
  c.known_bytes.assign(n, 0);
  c.g.assign(n, T(0));
  c.r.resize(n);

  double const mass = log_uniform(o.mass_low, o.mass_high);
  Vec3<T> heading = mpmpbd::direction(arrow());
  for (std::size_t k = 0; k < n; ++k) {
    T const bead_mass = T(mass * (1 + 0.2 * unit(random)));
    c.blocks[k].A += bead_mass * Mat3<T>::identity();
    c.r[k] += bead_mass * arrow();
    bool const last = k + 1 == n;
    if (o.known && !(last && o.ends == Ends::swaged)) c.known_bytes[k] = unit(random) < 0.15;
    if (last) continue;
    if (!o.straight) heading = mpmpbd::direction(heading + T(0.4) * arrow());
    bool const gap = o.gaps && !o.held_by_tissue && unit(random) < 0.1;
    c.links[k] = gap ? mpmpbd::Link<T>{{}, T(1)}
                     : mpmpbd::Link<T>{heading, o.inextensible ? T(0) : T(log_uniform(1e-4, 1))};
    c.g[k] = gap ? T(0) : T(0.1 * normal(random));
    if (gap) continue;
    Mat3<T> const across = Mat3<T>::identity() - mpmpbd::outer(heading, heading);
    T const tension = T(unit(random) < 0.5 ? 0 : log_uniform(1e-3, 1));
    c.blocks[k].A += tension * across;
    c.blocks[k + 1].A += tension * across;
    c.blocks[k].U -= tension * across;
    if (unit(random) < (o.held_by_tissue ? 1.0 : 0.6)) {  // two contact points
      for (T s : {T(0.2113), T(0.7887)}) {
        T const stick = unit(random) < (o.held_by_tissue ? 1.0 : 0.5) ? T(1) : T(0);
        Mat3<T> const B =
            T(log_uniform(0.1, 3)) * (across + stick * mpmpbd::outer(heading, heading));
        c.blocks[k].A += (1 - s) * (1 - s) * B;
        c.blocks[k + 1].A += s * s * B;
        c.blocks[k].U += s * (1 - s) * B;
        Vec3<T> const f = B * arrow();  // the tissue moves at a speed of about 1
        c.r[k] += (1 - s) * f;
        c.r[k + 1] += s * f;
      }
    }
    if constexpr (bends)
      if (k > 0 && mpmpbd::norm(c.links[k - 1].direction) > 0) {
        T const stiff = T(log_uniform(1e-2, 10));
        Vec3<T> const a = mpmpbd::direction(arrow());
        T const w[3] = {1, -2, 1};
        Mat3<T> const H = stiff * mpmpbd::outer(a, a);
        for (std::size_t i = 0; i < 3; ++i) c.blocks[k - 1 + i].A += w[i] * w[i] * H;
        c.blocks[k - 1].U += w[0] * w[1] * H;
        c.blocks[k].U += w[1] * w[2] * H;
        c.blocks[k - 1].W += w[0] * w[2] * H;
      }
  }
  for (std::size_t k = 0; k < n; ++k)
    if (c.known_bytes[k]) c.r[k] = arrow();
  c.end.present = o.ends != Ends::free;
  c.end.swaged = o.ends == Ends::swaged;
  c.end.arm = T(2) * arrow();
  Eigen::Matrix<double, 6, 6> root;
  for (int i = 0; i < 36; ++i) root(i) = normal(random);
  root = (root * root.transpose() + Eigen::Matrix<double, 6, 6>::Identity()).eval();
  for (int i = 0; i < 6; ++i) {
    c.y[i] = T(normal(random));
    for (int j = 0; j < 6; ++j) c.end.matrix(i, j) = T(root(std::min(i, j), std::max(i, j)));
  }
  return c;
}

inline Eigen::Vector3d eigen(mpmpbd::Vec3<float> const& a) { return {a[0], a[1], a[2]}; }
inline Eigen::Vector3d eigen(mpmpbd::Vec3<double> const& a) { return {a[0], a[1], a[2]}; }
template <class T> Eigen::Matrix3d eigen(mpmpbd::Mat3<T> const& a) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i) = double(a.m[i]);
  return m;
}

// All equations as one matrix in double: 3 rows per bead, one per link, 6 for the body. A known bead has
// the row V = V*; the swaged bead has no row of its own, its equation is added to the body's.
template <class T, bool bends> struct DenseChain {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd rhs;
  int n;
  int bead(int k) const { return 3 * k; }
  int link(int k) const { return 3 * n + k; }
  int body() const { return 3 * n + n - 1; }

  explicit DenseChain(RandomChain<T, bends> const& c) : n(c.beads()) {
    int const size = 3 * n + n - 1 + 6;
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    for (int k = 0; k < n; ++k) {
      auto const i = static_cast<std::size_t>(k);
      m.block<3, 3>(bead(k), bead(k)) = eigen(c.blocks[i].A);
      b.segment<3>(bead(k)) = eigen(c.r[i]);
      if (k + 1 < n) couple(m, k, k + 1, eigen(c.blocks[i].U));
      if constexpr (bends)
        if (k + 2 < n) couple(m, k, k + 2, eigen(c.blocks[i].W));
      if (k + 1 == n) continue;
      Eigen::Vector3d const d = eigen(c.links[i].direction);
      m.block<3, 1>(bead(k), link(k)) = -d;
      m.block<3, 1>(bead(k + 1), link(k)) = d;
      m.block<1, 3>(link(k), bead(k)) = -d.transpose();
      m.block<1, 3>(link(k), bead(k + 1)) = d.transpose();
      m(link(k), link(k)) = -double(c.links[i].compliance);
      b(link(k)) = double(c.g[i]);
    }
    for (int k = 0; k < n; ++k)
      if (c.known()[k]) {
        m.middleRows<3>(bead(k)).setZero();
        m.block<3, 3>(bead(k), bead(k)).setIdentity();
      }
    Eigen::MatrixXd reach =
        Eigen::MatrixXd::Identity(size, size);  // all unknowns from the free ones
    if (c.end.present) {
      for (int i = 0; i < 6; ++i) {
        b(body() + i) = double(c.y[i]);
        for (int j = 0; j < 6; ++j) m(body() + i, body() + j) = double(c.end.matrix(i, j));
      }
    } else {
      m.block<6, 6>(body(), body()).setIdentity();
    }
    matrix = m;
    rhs = b;
    if (c.end.swaged) {
      Eigen::Vector3d const arm = eigen(c.end.arm);
      Eigen::Matrix3d cross;
      cross << 0, -arm(2), arm(1), arm(2), 0, -arm(0), -arm(1), arm(0), 0;
      reach.middleRows<3>(bead(n - 1)).setZero();
      reach.block<3, 3>(bead(n - 1), body()).setIdentity();
      reach.block<3, 3>(bead(n - 1), body() + 3) = -cross;
      matrix = reach.transpose() * m * reach;
      rhs = reach.transpose() * b;
      matrix.block<3, 3>(bead(n - 1), bead(n - 1)).setIdentity();
    }
  }
  static void couple(Eigen::MatrixXd& m, int i, int j, Eigen::Matrix3d const& block) {
    m.block<3, 3>(3 * i, 3 * j) = block;
    m.block<3, 3>(3 * j, 3 * i) = block.transpose();
  }
};

}  // namespace test
