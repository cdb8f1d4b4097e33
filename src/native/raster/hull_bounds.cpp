#include "raster/hull_bounds.h"

#include <cmath>

namespace nofacet {
namespace {

constexpr double kMostLean = 20.0;  // beyond it the box itself serves as well

// x by y from one corner of the net to another.
double lean_between(const double* p, const double* q) {
  return (q[kX] / q[kW] - p[kX] / p[kW]) / (q[kY] / q[kW] - p[kY] / p[kW]);
}

Interval upright_range(const Net& net, double lean) {
  Interval range = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    range.include((p[kX] - lean * p[kY]) / p[kW]);
  }
  return range;
}

}  // namespace

HullBounds hull_bounds(const Net& net, Interval x, Interval y, Interval key) {
  HullBounds bounds{x, y, key, fit_key_plane(net, key), 0.0, x};
  const double* first = net.at(0, 0);
  for (const double* last : {net.at(net.n, 0), net.at(0, net.m), net.at(net.n, net.m)}) {
    const double lean = lean_between(first, last);
    if (!(std::fabs(lean) < kMostLean)) continue;
    const Interval upright = upright_range(net, lean);
    if (upright.width() < bounds.upright.width()) bounds.lean = lean, bounds.upright = upright;
  }
  return bounds;
}

}  // namespace nofacet
