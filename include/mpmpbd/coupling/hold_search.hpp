// Which points stick, slide, stand open or are at their cap: found by trial, in one pass of the exchange each.
//
// Which one-sided points touch is a linear complementarity problem, solved by block principal pivoting (Judice
// and Pires 1994): those that pull let go, those that would go in take hold, all at once while that leaves
// fewer of them wrong, else one at a time. Should it not end, or one and the same point stay wrong, they only let go
// until none pulls and no tip exceeds its cap: these limits are hard. Letting go alone would not do: held at once by all
// its points, a stiff thread pulls at every second one, and it would end with none.
#pragma once

#include <mpmpbd/coupling/contact_law.hpp>
#include <mpmpbd/coupling/exchange_view.hpp>

namespace mpmpbd::detail {

// How often at most one-sided points let go and take hold again, one pass each, and after that only let go;
// how many of these trials may leave as many of them wrong as before, or the same one.
inline constexpr int most_trials = 16, most_releases = 8, patience = 3;

// How a trial is judged: what lets go, slides or is at its cap; what was wrong in that (regrip: in the first sweep); which
// one-sided points touch; and which of these have to let go.
enum class Revision { yield, regrip, reconsider, settle, release };

// Holds that should change: how many, and the sum of their places; of a single one, its place.
struct Wrong {
  int count, places;
};

// How block pivoting gets on.
class Pivoting {
 public:
  MPMPBD_HD explicit Pivoting(int points) : fewest_(points + 1) {}

  MPMPBD_HD void meet(Wrong const& wrong) {
    bool const alone = wrong.count == 1;
    left_ = wrong.count < fewest_ ? patience : left_ - 1;
    fewest_ = min(fewest_, wrong.count);
    repeated_ = alone && wrong.places == last_ ? repeated_ + 1 : 0;
    last_ = alone ? wrong.places : -1;
    ++trials_;
  }
  // Whether all that are wrong may change at once.
  MPMPBD_HD bool gains() const { return left_ >= 0; }
  // Whether points have to let go from here on.
  MPMPBD_HD bool gives_up() const { return trials_ == most_trials || repeated_ == patience; }
  MPMPBD_HD bool ended() const { return trials_ == most_trials + most_releases; }

 private:
  int trials_ = 0, fewest_, left_ = patience, last_ = -1, repeated_ = 0;
};

template <class Exchange> struct HoldSearch {
  using T = typename Exchange::Scalar;

  Exchange const& exchange;
  typename Exchange::View const& x;
  typename Exchange::Team const& team;

  MPMPBD_HD explicit HoldSearch(Exchange const& e) : exchange(e), x(e.x), team(e.team) {}

  // The first trial lets points slide and let go; a second one takes back what was wrong in that. Where one-sided points
  // still are, it goes on with them. `first`: in the first sweep, of which lateral loads alone matter.
  MPMPBD_HD void find(bool first) const {
    Revision how = Revision::yield;
    Pivoting pivoting(x.count());
    for (bool fresh = true;;) {  // holds that no trial has seen
      if (fresh) exchange.pass();
      if (pivoting.ended()) return;
      Wrong const wrong = judge(how);
      fresh = wrong.count > 0;
      bool all = true;
      switch (how) {
        case Revision::yield:
          if (!fresh && !Exchange::Law::grips) return;
          how = first ? Revision::regrip : Revision::reconsider;
          break;
        case Revision::regrip:
        case Revision::reconsider:
          if (!fresh) return;
          how = Revision::settle;
          break;
        default:
          if (!fresh) return;
          pivoting.meet(wrong);
          all = how == Revision::release || pivoting.gains();
          if (pivoting.gives_up()) how = Revision::release;
      }
      if (fresh) adopt(all);
    }
  }

 private:
  // Judges every hold after a trial.
  MPMPBD_HD Wrong judge(Revision how) const {
    team.one([&] { x.scratch->changed = x.scratch->places = 0; });
    team.sync();
    team.each(x.count(), [&](int q) {
      PointWork<T>& w = x.work[q];
      w.next = x.on[q] ? judged(q, how) : w.hold;
      if (w.next == w.hold) return;
      team.add(x.scratch->changed, 1);
      team.add(x.scratch->places, q);
    });
    team.sync();
    Wrong const wrong{x.scratch->changed, x.scratch->places};
    team.sync();
    return wrong;
  }
  // Changes the holds as judged: all of them, or the last that is wrong.
  MPMPBD_HD void adopt(bool all) const {
    team.one([&] {
      x.scratch->revised = 1;
      int q = all ? -1 : x.count() - 1;
      while (q >= 0 && x.work[q].next == x.work[q].hold) --q;
      if (q >= 0) x.work[q].hold = x.work[q].next;
    });
    team.each(all ? x.count() : 0, [&](int q) { x.work[q].hold = x.work[q].next; });
    team.sync();
  }

  // What the hold of point q should be.
  MPMPBD_HD Hold judged(int q, Revision how) const {
    bool const one_sided = is_one_sided(x.points[q]);
    switch (how) {
      case Revision::yield:
        return one_sided ? settles(q) : yields(q);
      case Revision::regrip:
        return x.work[q].hold == Hold::open ? settles(q) : reconsiders(q);
      case Revision::reconsider:
        return reconsiders(q);
      case Revision::settle:
        return one_sided ? settles(q) : x.work[q].hold;
      default:
        return one_sided ? yields(q) : x.work[q].hold;
    }
  }
  MPMPBD_HD Hold yields(int q) const {
    PointWork<T>& w = x.work[q];
    return exchange.law.yields(x.points[q], w.hold, w.J + w.dJ, w.slip_impulse);
  }
  MPMPBD_HD Hold returns(int q) const {
    PointWork<T> const& w = x.work[q];
    return exchange.law.returns(x.points[q], w.hold, w.J + w.dJ,
                                add_product(w.u, w.D, w.dJ) - exchange.body_velocity(q));
  }
  MPMPBD_HD Hold reconsiders(int q) const {
    PointWork<T>& w = x.work[q];
    Hold const next = returns(q);
    if (next != w.hold) w.slip_impulse = {};
    return is_one_sided(x.points[q]) && next == w.hold ? yields(q) : next;
  }
  // What takes hold again slides freely until the next sweep. If it stuck, it could pull although it would push
  // when it slides, and trials would go on for ever. The first sweep, of which lateral loads alone matter, lets it slide at once.
  MPMPBD_HD Hold settles(int q) const {
    PointWork<T>& w = x.work[q];
    if (w.hold != Hold::open && w.hold != Hold::full) return yields(q);
    Hold const next = returns(q);
    if (next == w.hold || x.points[q].contact == Contact::tip) return next;
    w.slip_impulse = {};
    return Hold::slide;
  }
};

}  // namespace mpmpbd::detail
