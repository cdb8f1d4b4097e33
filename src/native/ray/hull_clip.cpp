#include "ray/hull_clip.h"

#include <cmath>

namespace nofacet {
namespace {

// Cut off less than the hull allows, by this part of what is left: its own arithmetic rounds too.
constexpr double kMargin = 1e-3;

struct Vector {
  double x, y;
};

// Where between i / n and k / n the segment from value p to value q crosses zero.
double crossing(int i, double p, int k, double q, int n) { return (i + (k - i) * (p / (p - q))) / n; }

// The part of [0, 1] in which the convex hull of the points (i / n, lo[i]) and (i / n, hi[i]) meets the axis.
bool hull_meets_axis(const double* lo, const double* hi, int n, Interval* range) {
  double first = 2.0, last = -1.0;
  for (int i = 0; i <= n; ++i) {
    if (lo[i] <= 0.0 && hi[i] >= 0.0) {
      first = std::min(first, double(i) / n);
      last = std::max(last, double(i) / n);
    }
    for (int k = i + 1; k <= n; ++k) {
      if (lo[i] > 0.0 && lo[k] <= 0.0) first = std::min(first, crossing(i, lo[i], k, lo[k], n));
      if (hi[i] < 0.0 && hi[k] >= 0.0) first = std::min(first, crossing(i, hi[i], k, hi[k], n));
      if (lo[i] <= 0.0 && lo[k] > 0.0) last = std::max(last, crossing(i, lo[i], k, lo[k], n));
      if (hi[i] >= 0.0 && hi[k] < 0.0) last = std::max(last, crossing(i, hi[i], k, hi[k], n));
    }
  }
  if (first > last) return false;
  const double margin = kMargin * (last - first) + 1e-15;
  *range = {std::max(0.0, first - margin), std::min(1.0, last + margin)};
  return true;
}

// Distances of the control points from the line through the bundle's middle with the given normal.
class Distances {
 public:
  Distances(const Net& net, const RayBundle& bundle, Vector normal, double rounding)
      : net_(net),
        x_(normal.x),
        y_(normal.y),
        w_(normal.x * bundle.x + normal.y * bundle.y),
        width_(std::fabs(normal.x) * bundle.half_x + std::fabs(normal.y) * bundle.half_y),
        rounding_(rounding * (std::fabs(normal.x) + std::fabs(normal.y))) {}

  bool clip_a(Interval* range) const {
    double lo[kMaxDegree + 1], hi[kMaxDegree + 1];
    for (int i = 0; i <= net_.n; ++i) {
      Interval d = Interval::empty();
      for (int j = 0; j <= net_.m; ++j) include(net_.at(i, j), &d);
      lo[i] = d.lo, hi[i] = d.hi;
    }
    return hull_meets_axis(lo, hi, net_.n, range);
  }
  bool clip_b(Interval* range) const {
    double lo[kMaxDegree + 1], hi[kMaxDegree + 1];
    for (int j = 0; j <= net_.m; ++j) {
      Interval d = Interval::empty();
      for (int i = 0; i <= net_.n; ++i) include(net_.at(i, j), &d);
      lo[j] = d.lo, hi[j] = d.hi;
    }
    return hull_meets_axis(lo, hi, net_.m, range);
  }

 private:
  void include(const double* p, Interval* d) const {
    const double distance = x_ * p[kX] + y_ * p[kY] - w_ * p[kW];
    const double room = width_ * std::fabs(p[kW]) + rounding_;
    d->lo = std::min(d->lo, distance - room);
    d->hi = std::max(d->hi, distance + room);
  }

  const Net& net_;
  double x_, y_, w_, width_, rounding_;
};

// Screen vector between two control points as seen from the bundle's middle, times their weight.
Vector difference(const double* p, const double* q, const RayBundle& bundle) {
  const double w = q[kW] - p[kW];
  return {q[kX] - p[kX] - bundle.x * w, q[kY] - p[kY] - bundle.y * w};
}

Vector sum(Vector p, Vector q) { return {p.x + q.x, p.y + q.y}; }

double size(Vector v) { return std::fabs(v.x) + std::fabs(v.y); }

}  // namespace

bool clip_net(const Net& net, const RayBundle& bundle, double rounding, Interval* a, Interval* b) {
  const int n = net.n, m = net.m;
  const double *p00 = net.at(0, 0), *p01 = net.at(0, m), *p10 = net.at(n, 0), *p11 = net.at(n, m);
  const Vector u = sum(difference(p00, p10, bundle), difference(p01, p11, bundle));
  const Vector v = sum(difference(p00, p01, bundle), difference(p10, p11, bundle));
  constexpr double kVanishes = 1e-9;
  Vector across_v{v.y, -v.x}, across_u{u.y, -u.x};
  if (size(v) <= kVanishes * size(u)) across_v = u;
  if (size(u) <= kVanishes * size(v)) across_u = v;
  if (size(u) + size(v) == 0.0) across_v = {1.0, 0.0}, across_u = {0.0, 1.0};
  return Distances(net, bundle, across_v, rounding).clip_a(a) && Distances(net, bundle, across_u, rounding).clip_b(b);
}

}  // namespace nofacet
