#include "raster/trim_portions.h"

#include <algorithm>
#include <cmath>

#include "raster/piece.h"

namespace nofacet {
namespace {

constexpr int kMaxHalvings = 40;

Interval ordered(double p, double q) { return p < q ? Interval{p, q} : Interval{q, p}; }

// Bounds of ds/du over an interval of u: for an angle the slope is smallest in the middle of the arc.
Interval slope_range(const ParameterMap& map, Interval u) {
  Interval slope = Interval::empty();
  slope.include(map.local(u.lo).slope);
  slope.include(map.local(u.hi).slope);
  const double middle = 0.5 * (map.u0 + map.u1);
  if (map.angular && u.lo < middle && middle < u.hi) slope.include(map.local(middle).slope);
  return slope;
}

// The part [*t0, *t1] of the arc inside the slab lo <= coordinate <= hi, for a coordinate from `first` to `last`.
template <class Inverse>
void clip_to_slab(Interval slab, double first, double last, const TrimArc& arc, Inverse inverse, double* t0,
                  double* t1) {
  const bool rising = first < last;
  const double enter = rising ? slab.lo : slab.hi, leave = rising ? slab.hi : slab.lo;
  if (rising ? first < enter && enter < last : last < enter && enter < first) *t0 = std::max(*t0, inverse(arc, enter));
  if (rising ? first < leave && leave < last : last < leave && leave < first) *t1 = std::min(*t1, inverse(arc, leave));
}

// A box that has some width even where the portion runs along a parameter line.
Interval padded(Interval r) {
  const double lo = std::clamp(r.lo - 1e-9, 0.0, 1.0 - 2e-9);
  return {lo, std::clamp(r.hi + 1e-9, lo + 1e-9, 1.0)};
}

// Whether the map from the piece's parameters to the screen is affine.
bool is_affine(const Piece& piece, const NetBounds& bounds) {
  return !piece.patch->u.angular && !piece.patch->v.angular && piece.planar && !piece.rational && piece.net.n == 1 &&
         piece.net.m == 1 && std::max(bounds.x.fab.magnitude(), bounds.y.fab.magnitude()) < kNegligiblePixels;
}

TrimPlace place_at(const Piece& piece, double u, double v) {
  const ParameterMap::Local s = piece.patch->u.local(u), t = piece.patch->v.local(v);
  const double s_width = piece.s1 - piece.s0, t_width = piece.t1 - piece.t0;
  double a = (s.s - piece.s0) / s_width, b = (t.s - piece.t0) / t_width;
  if (piece.transposed) std::swap(a, b);
  return {u, v, a, b, s.slope / s_width, t.slope / t_width, ScreenJet(evaluate(piece.net, a, b))};
}

// The point `place` of a curve that runs through it.
TrimPoint point_at(const Piece& piece, const TrimPlace& place, double t, const CurvePoint& c) {
  double at = c.du * place.s_slope, bt = c.dv * place.t_slope;
  if (piece.transposed) std::swap(at, bt);
  const ScreenJet& screen = place.screen;
  return {t,
          place.u,
          place.v,
          place.a,
          place.b,
          screen.x,
          screen.y,
          screen.key,
          at,
          bt,
          screen.xa * at + screen.xb * bt,
          screen.ya * at + screen.yb * bt,
          screen.ka * at + screen.kb * bt};
}

}  // namespace

TrimPoint trim_point(const Piece& piece, const TrimArc& arc, double t) {
  const CurvePoint c = arc.at(t);
  return point_at(piece, place_at(piece, c.u, c.v), t, c);
}

PortionFinder::PortionFinder(const Piece& piece, const NetBounds& bounds, const ScanPlanes& planes,
                             std::vector<TrimPortion>& portions, std::vector<double>& events)
    : piece_(piece),
      whole_(bounds),
      planes_(planes),
      portions_(portions),
      events_(events),
      u_{piece.patch->u.face_from_patch(piece.s0), piece.patch->u.face_from_patch(piece.s1)},
      v_{piece.patch->v.face_from_patch(piece.t0), piece.patch->v.face_from_patch(piece.t1)},
      s_slope_(slope_range(piece.patch->u, u_)),
      t_slope_(slope_range(piece.patch->v, v_)),
      affine_(is_affine(piece, bounds)) {}

void PortionFinder::add(const TrimArc& arc) {
  double t0 = arc.t0, t1 = arc.t1;
  clip_to_slab(u_, arc.u0, arc.u1, arc, [](const TrimArc& c, double x) { return c.parameter_at_u(x); }, &t0, &t1);
  clip_to_slab(v_, arc.v0, arc.v1, arc, [](const TrimArc& c, double x) { return c.parameter_at_v(x); }, &t0, &t1);
  if (!(t0 < t1)) return;
  const TrimPoint from = end(arc, t0), to = end(arc, t1);
  find(arc, from, to, 0);
}

TrimPoint PortionFinder::end(const TrimArc& arc, double t) {
  const CurvePoint c = arc.at(t);
  if (!last_end_ || last_end_->u != c.u || last_end_->v != c.v) last_end_ = place_at(piece_, c.u, c.v);
  return point_at(piece_, *last_end_, t, c);
}

void PortionFinder::find(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to, int halvings) {
  if (settle(arc, from, to, rise(arc.du, arc.dv, s_slope_, t_slope_, whole_.y.fa, whole_.y.fb))) return;
  Interval du, dv;
  derivative_bounds(arc.points, arc.degree, from.t, to.t, &du, &dv);
  const Interval s_slope = slope_range(piece_.patch->u, ordered(from.u, to.u));
  const Interval t_slope = slope_range(piece_.patch->v, ordered(from.v, to.v));
  Interval slope = rise(du, dv, s_slope, t_slope, whole_.y.fa, whole_.y.fb);
  if (settle(arc, from, to, slope)) return;
  const NetBounds part(restricted(ordered(from.a, to.a), ordered(from.b, to.b)));
  if (!planes_.any_in(part.y.f.lo, part.y.f.hi)) return add_event(part.y.f.lo);
  // Derivatives of the restricted net are by its own parameters.
  slope = intersect(slope, rise(du, dv, s_slope, t_slope, part.y.fa * (1.0 / a_width_), part.y.fb * (1.0 / b_width_)));
  if (settle(arc, from, to, slope)) return;
  // A portion that is level to within kSliverPixels may be taken for monotone: that moves it by no more.
  if ((slope * (to.t - from.t)).magnitude() < kSliverPixels || halvings >= kMaxHalvings) {
    return keep(arc, from, to);
  }
  const TrimPoint middle = trim_point(piece_, arc, 0.5 * (from.t + to.t));
  find(arc, from, middle, halvings + 1);
  find(arc, middle, to, halvings + 1);
}

// Whether bounds of dy/dt tell what to do: no plane meets the part, or y moves one way.
bool PortionFinder::settle(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to, Interval slope) {
  // Where y may be, by the mean value theorem from both ends.
  const Interval run = slope * (to.t - from.t);
  const Interval y = intersect({from.y + std::min(0.0, run.lo), from.y + std::max(0.0, run.hi)},
                               {to.y - std::max(0.0, run.hi), to.y - std::min(0.0, run.lo)});
  if (!planes_.any_in(y.lo, y.hi)) {
    add_event(y.lo);
    return true;
  }
  if (!slope.one_signed()) return false;
  keep(arc, from, to);
  return true;
}

void PortionFinder::keep(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to) {
  // A straight line in (u, v) is one on the screen if the map is affine.
  const bool straight = affine_ && arc.degree == 1 && arc.points[2] == arc.points[5];
  portions_.push_back({&arc, from, to, straight});
  add_event(from.y);
  add_event(to.y);
}

// Bounds of dy/dt from those of the curve's derivatives, of the patch's parameters by the face's, and of y by the
// piece's.
Interval PortionFinder::rise(Interval du, Interval dv, Interval s_slope, Interval t_slope, Interval ya,
                             Interval yb) const {
  Interval da = du * s_slope * (1.0 / (piece_.s1 - piece_.s0)), db = dv * t_slope * (1.0 / (piece_.t1 - piece_.t0));
  if (piece_.transposed) std::swap(da, db);
  return ya * da + yb * db;
}

// The piece's net over a box, padded so that it has some width for a portion along a parameter line.
Net PortionFinder::restricted(Interval a, Interval b) {
  const Interval pa = padded(a), pb = padded(b);
  a_width_ = pa.width(), b_width_ = pb.width();
  scratch_.resize(piece_.net.size());
  restrict_net(piece_.net, pa.lo, pa.hi, pb.lo, pb.hi, scratch_.data());
  return {piece_.net.n, piece_.net.m, scratch_.data()};
}

// Neighbouring events are mostly between the same two planes.
void PortionFinder::add_event(double y) {
  if (!events_.empty()) {
    const Interval gap = ordered(events_.back(), y);
    if (!planes_.any_in(gap.lo, gap.hi)) return;
  }
  events_.push_back(y);
}

void PortionFinder::finish() {
  std::sort(events_.begin(), events_.end());
  const auto together = [&](double p, double q) { return !planes_.any_in(p, q); };
  events_.erase(std::unique(events_.begin(), events_.end(), together), events_.end());
}

}  // namespace nofacet
