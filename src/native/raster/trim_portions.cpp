#include "raster/piece.h"

namespace nofacet {
namespace {

constexpr int kMaxHalvings = 40;

// Bounds of ds/du over an interval of u: for an angle the slope is smallest in the middle of the arc.
Interval slope_range(const ParameterMap& map, Interval u) {
  Interval slope = Interval::empty();
  slope.include(map.patch_slope(u.lo));
  slope.include(map.patch_slope(u.hi));
  const double middle = 0.5 * (map.u0 + map.u1);
  if (map.angular && u.lo < middle && middle < u.hi) slope.include(map.patch_slope(middle));
  return slope;
}

class PortionFinder {
 public:
  PortionFinder(const Piece& piece, const NetBounds& bounds, const TrimArc& arc, const ScanPlanes& planes,
                std::vector<TrimPortion>& out)
      : piece_(piece), whole_(bounds), arc_(arc), planes_(planes), out_(out) {}

  struct End : TrimPortion::End {
    double u, v;
  };

  End end(double t) const {
    const CurvePoint c = arc_.at(t);
    End e{{t, 0, 0, 0, 0, 0}, c.u, c.v};
    piece_.local_from_face(c.u, c.v, &e.a, &e.b);
    const Jet jet = evaluate(piece_.net, e.a, e.b);
    e.x = jet.p[kX] / jet.p[kW], e.y = jet.p[kY] / jet.p[kW], e.key = jet.p[kZ] / jet.p[kW];
    return e;
  }

  void find(const End& from, const End& to, int halvings) {
    Interval du, dv;
    derivative_bounds(arc_.points, arc_.degree, from.t, to.t, &du, &dv);
    Interval da = du * slope_range(piece_.patch->u, ordered(from.u, to.u)) * (1.0 / (piece_.s1 - piece_.s0));
    Interval db = dv * slope_range(piece_.patch->v, ordered(from.v, to.v)) * (1.0 / (piece_.t1 - piece_.t0));
    if (piece_.transposed) std::swap(da, db);
    const Interval a = ordered(from.a, to.a), b = ordered(from.b, to.b);
    Interval slope = whole_.y.fa * da + whole_.y.fb * db;  // dy/dt
    if (!slope.one_signed()) {
      const NetBounds part(restricted(a, b));
      if (!planes_.any_in(part.y.f.lo, part.y.f.hi)) return skip(part.y.f);
      // Derivatives of the restricted net are by its own parameters.
      slope = intersect(slope, part.y.fa * (1.0 / a_width_) * da + part.y.fb * (1.0 / b_width_) * db);
    }
    // Mean value bounds of y, from both ends.
    const Interval run = slope * (to.t - from.t);
    const Interval range = intersect({from.y + std::min(0.0, run.lo), from.y + std::max(0.0, run.hi)},
                                     {to.y - std::max(0.0, run.hi), to.y - std::min(0.0, run.lo)});
    if (!planes_.any_in(range.lo, range.hi)) return skip(range);
    // A portion that is level to within kSliverPixels may be taken for monotone: that moves it by no more.
    if (slope.one_signed() || run.magnitude() < kSliverPixels || halvings >= kMaxHalvings) {
      out_.push_back({&arc_, from, to, is_straight()});
      return;
    }
    const End middle = end(0.5 * (from.t + to.t));
    find(from, middle, halvings + 1);
    find(middle, to, halvings + 1);
  }

 private:
  // No scan plane meets it.
  void skip(Interval y) const {
    TrimPortion portion{};
    portion.from.y = y.lo, portion.to.y = y.hi;
    out_.push_back(portion);
  }

  // A straight line in (u, v) on a plane seen without perspective.
  bool is_straight() const {
    const Scene::PatchRef& patch = *piece_.patch;
    return arc_.degree == 1 && arc_.points[2] == arc_.points[5] && !patch.u.angular && !patch.v.angular &&
           piece_.planar && !piece_.rational && piece_.net.n == 1 && piece_.net.m == 1 &&
           std::max(whole_.x.fab.magnitude(), whole_.y.fab.magnitude()) < kNegligiblePixels;
  }

  static Interval ordered(double p, double q) { return p < q ? Interval{p, q} : Interval{q, p}; }

  // The piece over the box of the portion, padded so that it has some width for an iso-parameter portion.
  Net restricted(Interval a, Interval b) {
    auto padded = [](Interval r) {
      const double lo = std::clamp(r.lo - 1e-9, 0.0, 1.0 - 2e-9), hi = std::clamp(r.hi + 1e-9, lo + 1e-9, 1.0);
      return Interval{lo, hi};
    };
    const Interval pa = padded(a), pb = padded(b);
    a_width_ = pa.width(), b_width_ = pb.width();
    scratch_.resize(piece_.net.size());
    restrict_net(piece_.net, pa.lo, pa.hi, pb.lo, pb.hi, scratch_.data());
    return {piece_.net.n, piece_.net.m, scratch_.data()};
  }

  const Piece& piece_;
  const NetBounds& whole_;
  const TrimArc& arc_;
  const ScanPlanes& planes_;
  std::vector<TrimPortion>& out_;
  std::vector<double> scratch_;
  double a_width_ = 1.0, b_width_ = 1.0;
};

// The part [*t0, *t1] of the arc inside the slab lo <= coordinate <= hi, for a coordinate from `first` to `last`.
template <class Inverse>
void clip_to_slab(double lo, double hi, double first, double last, const TrimArc& arc, Inverse inverse, double* t0,
                  double* t1) {
  const bool rising = first < last;
  const double enter = rising ? lo : hi, leave = rising ? hi : lo;
  if (rising ? first < enter && enter < last : last < enter && enter < first) *t0 = std::max(*t0, inverse(arc, enter));
  if (rising ? first < leave && leave < last : last < leave && leave < first) *t1 = std::min(*t1, inverse(arc, leave));
}

}  // namespace

void monotone_portions(const Piece& piece, const NetBounds& bounds, const TrimArc& arc, const ScanPlanes& planes,
                       std::vector<TrimPortion>& out) {
  double t0 = arc.t0, t1 = arc.t1;
  const ParameterMap &u = piece.patch->u, &v = piece.patch->v;
  clip_to_slab(
      u.face_from_patch(piece.s0), u.face_from_patch(piece.s1), arc.u0, arc.u1, arc,
      [](const TrimArc& c, double x) { return c.parameter_at_u(x); }, &t0, &t1);
  clip_to_slab(
      v.face_from_patch(piece.t0), v.face_from_patch(piece.t1), arc.v0, arc.v1, arc,
      [](const TrimArc& c, double x) { return c.parameter_at_v(x); }, &t0, &t1);
  if (!(t0 < t1)) return;
  PortionFinder finder(piece, bounds, arc, planes, out);
  finder.find(finder.end(t0), finder.end(t1), 0);
}

}  // namespace nofacet
