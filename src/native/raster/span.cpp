#include "raster/span.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

// Parameters and pixels; far above rounding, and below any stretch that lasts for many planes.
constexpr double kLongStretch = 1e-6;

// Bounds of the key between two points of a cut: by the mean value theorem from both ends, and by how far a curve that
// bends no more than the piece's cuts do can rise above and fall below its ends.
Interval bound_key(const Piece& piece, double a0, double key0, double a1, double key1) {
  const Interval run = piece.key_slope * (a1 - a0);
  const Interval from_0{key0 + std::min(0.0, run.lo), key0 + std::max(0.0, run.hi)};
  const Interval from_1{key1 - std::max(0.0, run.hi), key1 - std::min(0.0, run.lo)};
  const double length = a1 - a0, bend = 0.5 * piece.key_bend.magnitude() * length * length,
               rise = std::fabs(key1 - key0);
  // A parabola of that bend through both ends; from rise = bend on its vertex is not between them.
  const double beyond = rise < bend ? 0.25 * (bend - rise) * (bend - rise) / bend : 0.0;
  const Interval bent{std::min(key0, key1) - beyond, std::max(key0, key1) + beyond};
  return intersect(intersect(intersect(from_0, from_1), bent), piece.hull.key);
}

}  // namespace

Interval Span::key_between(double a_from, double key_from, double a_to, double key_to) const {
  return bound_key(*piece, a_from, key_from, a_to, key_to);
}

namespace {

void append_untrimmed(const Piece& piece, double y, const CutArc& arc, int plane, int width, const CutPoint& from,
                      const CutPoint& to, std::vector<Span>& out) {
  const CutPoint &left = from.x <= to.x ? from : to, &right = from.x <= to.x ? to : from;
  if (!(left.x < right.x) || right.x <= 0.0 || left.x >= width) return;
  const Interval key = bound_key(piece, left.a, left.key, right.a, right.key);
  out.push_back({&piece, y, left.x, right.x, left.a, left.b, right.a, right.b, left.key, right.key, key.lo, key.hi,
                 plane, left.fold, right.fold, uint16_t(arc.curve)});
}

}  // namespace

void SpanMaker::append(const Piece& piece, const double* y, int count, int first_plane, int width,
                       std::vector<Span>& out) {
  if (piece.kind == CutKind::uncertain) return append_point(piece, y, count, first_plane, width, out);
  const std::vector<CutArc>& arcs = cutter_.cut(piece, y, count);
  if (!piece.region) {
    for (const CutArc& arc : arcs) {
      append_untrimmed(piece, y[arc.plane], arc, first_plane + arc.plane, width, arc.from, arc.to, out);
    }
    return;
  }
  const std::vector<TrimCrossing>& crossings = crosser_.cross(piece, y, count);
  next_event_ = 0;
  inside_.clear();
  std::size_t first = 0, last = 0;  // crossings of the plane
  int plane = -1;
  for (const CutArc& arc : arcs) {
    const double level = y[arc.plane];
    if (arc.plane != plane) {
      plane = arc.plane;
      for (first = last; first < crossings.size() && crossings[first].plane < plane;) ++first;
      for (last = first; last < crossings.size() && crossings[last].plane == plane;) ++last;
      if (!same_layout(piece, {crossings.data() + first, last - first}, level)) inside_.assign(last - first + 1, -1);
    }
    const auto add = [&](const CutPoint& from, const CutPoint& to, std::size_t stretch) {
      // Trim curves run along the piece's borders but for rounding.
      if (std::fabs(to.x - from.x) < kNegligiblePixels) return;
      if (inside(piece, level, from, to, stretch)) {
        append_untrimmed(piece, level, arc, first_plane + plane, width, from, to, out);
      }
    };
    CutPoint from = arc.from;
    for (std::size_t k = first; k < last; ++k) {
      const CutPoint& crossing = crossings[k].point;
      if (crossing.a <= from.a) continue;
      if (crossing.a >= arc.to.a) {
        add(from, arc.to, k - first);
        from = arc.to;
        break;
      }
      add(from, crossing, k - first);
      from = crossing;
    }
    if (from.a < arc.to.a) add(from, arc.to, last - first);
  }
}

// Whether the plane y, which has these crossings, is cut as the plane before it was.
bool SpanMaker::same_layout(const Piece& piece, std::span<const TrimCrossing> crossings, double y) {
  bool same = !inside_.empty() && (next_event_ == piece.event_count || piece.events[next_event_] > y);
  while (next_event_ < piece.event_count && piece.events[next_event_] <= y) ++next_event_;
  same &= layout_.size() == crossings.size();
  for (std::size_t k = 0; same && k < crossings.size(); ++k) same = layout_[k] == crossings[k].portion;
  if (same) return true;
  layout_.clear();
  for (const TrimCrossing& crossing : crossings) layout_.push_back(crossing.portion);
  return false;
}

namespace {

constexpr double kNearCut = 1e-9;

// As cut_at, by Newton's method on the centred net, to where a step is below kNearCut; NaN if that strays.
double cut_near(const Piece& piece, double y, double a, double guess) {
  constexpr int kMaxSteps = 6;
  const CentredNet& net = piece.centred;
  if (!piece.has_accurate_centred_net()) return NAN;
  double d[kMaxDegree + 1] = {};  // Y - y W on the line a, in powers of b - 1/2
  const double s = a - 0.5, level = y - net.y;
  for (int i = net.n; i >= 0; --i) {
    const double* p = net.points + 4 * std::size_t(i) * (net.m + 1);
    for (int j = 0; j <= net.m; ++j, p += 4) d[j] = d[j] * s + (p[kY] - level * p[kW]);
  }
  double b = guess - 0.5;
  for (int step = 0; step < kMaxSteps && std::fabs(b) <= 0.5; ++step) {
    double value = d[net.m], slope = 0.0;
    for (int j = net.m - 1; j >= 0; --j) slope = slope * b + value, value = value * b + d[j];
    const double change = value / slope;
    b -= change;
    if (std::fabs(change) < kNearCut) return std::fabs(b) <= 0.5 ? b + 0.5 : NAN;
  }
  return NAN;
}

}  // namespace

// Whether the stretch is inside the trim loops, by its middle.
bool SpanMaker::inside(const Piece& piece, double y, const CutPoint& from, const CutPoint& to, std::size_t stretch) {
  signed char& known = inside_[stretch];
  if (known >= 0) return known == 1;
  const double a = 0.5 * (from.a + to.a), guess = 0.5 * (from.b + to.b), near = cut_near(piece, y, a, guess);
  double u, v;
  piece.face_from_local(a, std::isfinite(near) ? near : cut_at(piece, y, a, guess), &u, &v);
  const bool result = piece.region->contains(u, v);
  // The middle of a short stretch may lie on a trim curve but for rounding: that says nothing of the next plane's.
  if (to.a - from.a > kLongStretch && std::fabs(to.x - from.x) > kLongStretch) known = result;
  return result;
}

void SpanMaker::append_point(const Piece& piece, const double* y, int count, int first_plane, int width,
                             std::vector<Span>& out) const {
  if (piece.hull.x.hi <= 0 || piece.hull.x.lo >= width) return;
  double u, v;
  piece.face_from_local(0.5, 0.5, &u, &v);
  if (piece.region && !piece.region->contains(u, v)) return;
  for (int k = 0; k < count; ++k) {
    if (!(piece.hull.y.lo <= y[k] && y[k] < piece.hull.y.hi)) continue;
    out.push_back({&piece, y[k], piece.hull.x.lo, piece.hull.x.hi, 0.5, 0.5, 0.5, 0.5, piece.hull.key.lo,
                   piece.hull.key.lo, piece.hull.key.lo, piece.hull.key.hi, first_plane + k, false, false, 0});
  }
}

namespace {

constexpr int kMaxNewton = 12;

bool newton(const Span& span, double x, double y, SurfaceSample* sample) {
  const double a_lo = std::min(span.a0, span.a1), a_hi = std::max(span.a0, span.a1);
  // The exact pixel centre may lie a shift of the samples outside the span: that much room, in the parameters.
  const double room = 1e-6 + 1e-7 / std::max(span.x1 - span.x0, 1e-9) * (a_hi - a_lo);
  double a = sample->a, b = sample->b;
  for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
    Jet& jet = sample->jet;
    jet = evaluate(span.piece->net, a, b);
    const ScreenJet screen(jet);
    const double rx = x - screen.x, ry = y - screen.y, determinant = screen.jacobian();
    const double da = (rx * screen.yb - ry * screen.xb) / determinant;
    const double db = (ry * screen.xa - rx * screen.ya) / determinant;
    if (!(std::fabs(da) < 2.0 && std::fabs(db) < 2.0)) return false;
    a += da, b += db;
    if (std::fabs(da) < 1e-7 && std::fabs(db) < 1e-7) {
      // One more evaluation would change the derivatives by 1e-7 and the point by 1e-14 of the piece.
      if (a < a_lo - room || a > a_hi + room || b < -1e-6 || b > 1.0 + 1e-6) return false;
      for (int c = 0; c < 4; ++c) jet.p[c] += da * jet.pa[c] + db * jet.pb[c];
      sample->a = a, sample->b = b;
      return true;
    }
    a = std::clamp(a, a_lo, a_hi);
    b = std::clamp(b, 0.0, 1.0);
  }
  return false;
}

// x grows along the span from a0 to a1: bracketed on the cut itself.
void bisect_cut(const Span& span, double x, SurfaceSample* sample) {
  double a0 = span.a0, a1 = span.a1, a = a0, b = span.b0;
  double x0 = span.x0, x1 = span.x1;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double fraction = iteration % 3 == 2 || x1 <= x0 ? 0.5 : std::clamp((x - x0) / (x1 - x0), 0.01, 0.99);
    const double next = a0 + fraction * (a1 - a0);
    if (next == a0 || next == a1) break;
    a = next;
    b = cut_at(*span.piece, span.y, a, b);
    sample->jet = evaluate(span.piece->net, a, b);
    const double at = sample->jet.p[kX] / sample->jet.p[kW];
    if (std::fabs(at - x) < 1e-11) break;
    (at < x ? a0 : a1) = a;
    (at < x ? x0 : x1) = at;
  }
  sample->a = a, sample->b = b;
  sample->jet = evaluate(span.piece->net, a, b);
}

}  // namespace

void solve_sample(const Span& span, double x, double y, SurfaceSample* sample) {
  if (span.piece->kind == CutKind::uncertain) {
    sample->a = sample->b = 0.5;
    sample->jet = evaluate(span.piece->net, 0.5, 0.5);
    return;
  }
  if (newton(span, x, y, sample)) return;
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  sample->a = span.a0 + fraction * (span.a1 - span.a0);
  sample->b = cut_at(*span.piece, span.y, sample->a, span.b0 + fraction * (span.b1 - span.b0));
  if (newton(span, x, y, sample)) return;
  bisect_cut(span, std::clamp(x, span.x0, span.x1), sample);
}

double key_at(const Span& span, double x, double* a) {
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  *a = span.a0 + fraction * (span.a1 - span.a0);
  if (span.piece->planar || fraction == 0.0 || fraction == 1.0) return span.key0 + fraction * (span.key1 - span.key0);
  SurfaceSample sample{*a, span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, span.y, &sample);
  *a = sample.a;
  return sample.jet.p[kZ] / sample.jet.p[kW];
}

}  // namespace nofacet
