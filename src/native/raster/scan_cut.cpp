#include "raster/scan_cut.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr int kMaxBreaks = 2 * kMaxDegree + 2;

// One end of a stretch of the cut.
struct CutPoint {
  double a, b;
  double x, depth;
  double x_slope;  // dx/da along the cut
};

CutPoint cut_point(const Piece& piece, const Camera& camera, double a, double b) {
  const Jet jet = evaluate(piece.net, a, b);
  const ScreenJet screen(jet);
  return {a, b, screen.x, camera.depth(jet.p), screen.x_along_cut()};
}

// d(a, 0) and d(a, 1), signed so that d grows with b.
void edge_polynomials(const Piece& piece, double y, double* low, double* high) {
  const Net& net = piece.net;
  const double sign = piece.rising ? 1.0 : -1.0;
  for (int i = 0; i <= net.n; ++i) {
    const double *p = net.at(i, 0), *q = net.at(i, net.m);
    low[i] = sign * (p[kY] - y * p[kW]);
    high[i] = sign * (q[kY] - y * q[kW]);
  }
}

struct Stretch {
  double from, to;
  // b at the ends where a border of the piece ends the cut (0 or 1); NaN where a itself is 0 or 1.
  double b_from, b_to;
};

// The intervals of a on which the cut exists: low(a) < 0 <= high(a). Half-open, so that neighbours share no cut.
int stretches(const Piece& piece, double y, Stretch* out) {
  const int n = piece.net.n;
  double low[kMaxDegree + 1], high[kMaxDegree + 1];
  edge_polynomials(piece, y, low, high);
  struct Break {
    double a, b;
  };
  Break breaks[kMaxBreaks];
  double roots[kMaxDegree + 1];
  int count = 0;
  breaks[count++] = {0.0, NAN};
  for (int k = bernstein_roots(low, n, roots); k-- > 0;) breaks[count++] = {roots[k], 0.0};
  for (int k = bernstein_roots(high, n, roots); k-- > 0;) breaks[count++] = {roots[k], 1.0};
  breaks[count++] = {1.0, NAN};
  if (count == 2) {
    if (!(low[0] < 0 && high[0] >= 0)) return 0;
    out[0] = {0.0, 1.0, NAN, NAN};
    return 1;
  }
  std::sort(breaks, breaks + count, [](const Break& p, const Break& q) { return p.a < q.a; });
  int found = 0;
  for (int k = 1; k < count; ++k) {
    if (breaks[k].a <= breaks[k - 1].a) continue;
    const double middle = 0.5 * (breaks[k - 1].a + breaks[k].a);
    if (bernstein_value(low, n, middle) < 0 && bernstein_value(high, n, middle) >= 0) {
      out[found++] = {breaks[k - 1].a, breaks[k].a, breaks[k - 1].b, breaks[k].b};
    }
  }
  return found;
}

// Where x turns between two points of the cut whose x slopes have opposite signs (Illinois' false position; an error e
// in a moves x by only its square).
CutPoint solve_fold(const Piece& piece, const Camera& camera, double y, CutPoint from, CutPoint to) {
  double fa = from.x_slope, fb = to.x_slope, a = from.a, b = to.a;
  int side = 0;
  CutPoint point = from;
  for (int iteration = 0; iteration < 100 && b - a > 1e-9; ++iteration) {
    double next = iteration % 8 == 7 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
    if (!(next > a && next < b)) next = 0.5 * (a + b);
    const double step = std::fabs(next - point.a);
    point = cut_point(piece, camera, next, cut_at(piece, y, next, point.b));
    if (point.x_slope == 0.0 || step < 1e-9) break;
    if ((point.x_slope < 0) == (fa < 0)) {
      a = next, fa = point.x_slope;
      if (side == -1) fb *= 0.5;
      side = -1;
    } else {
      b = next, fb = point.x_slope;
      if (side == 1) fa *= 0.5;
      side = 1;
    }
  }
  return point;
}

// Where the trim portion crosses the scan plane, as (a, b) of the piece.
void solve_crossing(const Piece& piece, const TrimPortion& portion, double y, double* a_out, double* b_out) {
  const double guess = portion.t0 + (portion.t1 - portion.t0) * (y - portion.y0) / (portion.y1 - portion.y0);
  const Scene::PatchRef& patch = *piece.patch;
  const double rs = 1.0 / (piece.s1 - piece.s0), rt = 1.0 / (piece.t1 - piece.t0);
  double a = 0, b = 0;
  auto height = [&](double t, double* slope) {
    const CurvePoint c = portion.arc->at(t);
    piece.local_from_face(c.u, c.v, &a, &b);
    double da = c.du * patch.u.patch_slope(c.u) * rs, db = c.dv * patch.v.patch_slope(c.v) * rt;
    if (piece.transposed) std::swap(da, db);
    const ScreenJet screen(evaluate(piece.net, a, b));
    *slope = screen.ya * da + screen.yb * db;
    return screen.y - y;
  };
  const double t = bracketed_newton(height, portion.t0, portion.t1, portion.y1 > portion.y0, guess);
  const CurvePoint c = portion.arc->at(t);
  piece.local_from_face(c.u, c.v, a_out, b_out);
}

class SpanWriter {
 public:
  SpanWriter(const Piece& piece, double y, const Camera& camera, std::vector<CutPoint>& crossings,
             std::vector<Span>& out)
      : piece_(piece), y_(y), camera_(camera), crossings_(crossings), out_(out) {
    crossings_.clear();
    for (int k = 0; k < piece.portion_count; ++k) {
      const TrimPortion& portion = piece.portions[k];
      if ((portion.y0 <= y) == (portion.y1 <= y)) continue;
      double a, b;
      solve_crossing(piece, portion, y, &a, &b);
      crossings_.push_back(cut_point(piece, camera, a, b));
    }
    std::sort(crossings_.begin(), crossings_.end(), [](const CutPoint& p, const CutPoint& q) { return p.a < q.a; });
  }

  // The cut from `from` to `to`, x monotone between them: cut at the trim crossings, keep what is inside.
  void add(CutPoint from, const CutPoint& to) {
    for (const CutPoint& crossing : crossings_) {
      if (crossing.a <= from.a || crossing.a >= to.a) continue;
      add_untrimmed(from, crossing);
      from = crossing;
    }
    add_untrimmed(from, to);
  }

 private:
  void add_untrimmed(const CutPoint& from, const CutPoint& to) {
    const CutPoint &left = from.x <= to.x ? from : to, &right = from.x <= to.x ? to : from;
    if (!(left.x < right.x) || right.x <= 0.0 || left.x >= camera_.width) return;
    if (piece_.region) {
      // Each stretch is classified by itself, at its middle, so no crossing can pass an error on to the next.
      const double a = 0.5 * (from.a + to.a);
      double u, v;
      piece_.face_from_local(a, cut_at(piece_, y_, a, 0.5 * (from.b + to.b)), &u, &v);
      if (!piece_.region->contains(u, v)) return;
    }
    const Interval run = piece_.depth_slope * (right.a - left.a);
    const double nearest =
        std::max({piece_.depth.lo, left.depth + std::min(0.0, run.lo), right.depth - std::max(0.0, run.hi)});
    out_.push_back({&piece_, y_, left.x, right.x, left.a, left.b, right.a, right.b, left.depth, right.depth, nearest});
  }

  const Piece& piece_;
  double y_;
  const Camera& camera_;
  std::vector<CutPoint>& crossings_;
  std::vector<Span>& out_;
};

}  // namespace

double cut_at(const Piece& piece, double y, double a, double guess) {
  const Net& net = piece.net;
  double d[kMaxDegree + 1];
  if (a == 0.0 || a == 1.0) {  // a border of the piece: its own control points
    const double* p = net.at(a == 0.0 ? 0 : net.n, 0);
    for (int j = 0; j <= net.m; ++j, p += 4) d[j] = p[kY] - y * p[kW];
  } else {
    double basis[kMaxDegree + 1];
    bernstein_basis(net.n, a, basis);
    std::fill(d, d + net.m + 1, 0.0);
    const double* p = net.points;
    for (int i = 0; i <= net.n; ++i) {
      for (int j = 0; j <= net.m; ++j, p += 4) d[j] += basis[i] * (p[kY] - y * p[kW]);
    }
  }
  if ((d[0] < 0) == (d[net.m] < 0)) {  // an end of the cut, lost to rounding: the border it lies on
    return std::fabs(d[0]) <= std::fabs(d[net.m]) ? 0.0 : 1.0;
  }
  const double secant = d[0] / (d[0] - d[net.m]);
  if (net.m == 1) return secant;
  if (!(guess > 0.0 && guess < 1.0)) guess = secant;
  return bracketed_newton([&](double b, double* slope) { return bernstein_value(d, net.m, b, slope); }, 0.0, 1.0,
                          d[0] < 0, guess);
}

void append_spans(const Piece& piece, double y, const Camera& camera, std::vector<Span>& out) {
  if (piece.kind == CutKind::uncertain) {
    if (!(piece.y.lo <= y && y < piece.y.hi) || piece.x.hi <= 0 || piece.x.lo >= camera.width) return;
    double u, v;
    piece.face_from_local(0.5, 0.5, &u, &v);
    if (piece.region && !piece.region->contains(u, v)) return;
    out.push_back(
        {&piece, y, piece.x.lo, piece.x.hi, 0.5, 0.5, 0.5, 0.5, piece.depth.lo, piece.depth.lo, piece.depth.lo});
    return;
  }
  Stretch found[kMaxBreaks];
  const int count = stretches(piece, y, found);
  if (count == 0) return;
  thread_local std::vector<CutPoint> crossings;
  SpanWriter writer(piece, y, camera, crossings, out);
  for (int k = 0; k < count; ++k) {
    const Stretch& s = found[k];
    const CutPoint from =
        cut_point(piece, camera, s.from, std::isnan(s.b_from) ? cut_at(piece, y, s.from, NAN) : s.b_from);
    const CutPoint to = cut_point(piece, camera, s.to, std::isnan(s.b_to) ? cut_at(piece, y, s.to, from.b) : s.b_to);
    if (piece.kind == CutKind::fold && (from.x_slope < 0) != (to.x_slope < 0)) {
      const CutPoint fold = solve_fold(piece, camera, y, from, to);
      writer.add(from, fold);
      writer.add(fold, to);
    } else {
      writer.add(from, to);
    }
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

double depth_at(const Span& span, double x, const Camera& camera, double* a) {
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  *a = span.a0 + fraction * (span.a1 - span.a0);
  if (span.piece->linear || fraction == 0.0 || fraction == 1.0)
    return span.depth0 + fraction * (span.depth1 - span.depth0);
  SurfaceSample sample{*a, span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, span.y, &sample);
  *a = sample.a;
  return camera.depth(sample.jet.p);
}

}  // namespace nofacet
