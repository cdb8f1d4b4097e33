// A rational Bezier patch's control net and its bounds. Points are homogeneous, (X, Y, W, Z): x = X / W, y = Y / W.
#pragma once
#include <cstddef>

#include "bezier/bernstein.h"
#include "bezier/interval.h"

namespace nofacet {

enum Component { kX = 0, kY = 1, kW = 2, kZ = 3 };

// Non-owning: points[(i * (m + 1) + j) * 4 + component]; i runs along the parameter a (degree n), j along b (degree m).
struct Net {
  int n = 0, m = 0;
  const double* points = nullptr;

  const double* at(int i, int j) const { return points + 4 * (std::size_t(i) * (m + 1) + j); }
  std::size_t size() const { return 4 * std::size_t(n + 1) * (m + 1); }
};

// Homogeneous point and its two partial derivatives.
struct Jet {
  double p[4], pa[4], pb[4];
};

Jet evaluate(const Net& net, double a, double b);
// The mixed second derivative of the homogeneous point by a and b.
void evaluate_mixed(const Net& net, double a, double b, double mixed[4]);

// Cuts a net of (n + 1) x (m + 1) points, each of `components` values, at a = t or b = t in two (de Casteljau); the
// shared border is bitwise the same in both. components: 1 or 4.
void split_net(const double* in, int n, int m, int components, bool along_a, double t, double* left, double* right);
// The part of the net over [a0, a1] x [b0, b1].
void restrict_net(const Net& net, double a0, double a1, double b0, double b1, double* out);
void transpose(const Net& net, double* out);

// Bounds over the piece of a quotient f = numerator / denominator and of its derivatives by a and b.
struct QuotientBounds {
  Interval f, fa, fb, faa, fab, fbb;
};
// With a and b exchanged.
inline QuotientBounds transposed_bounds(const QuotientBounds& q) { return {q.f, q.fb, q.fa, q.fbb, q.fab, q.faa}; }

// Ranges of X, Y, W and Z over the control points of a form.
struct ComponentRanges {
  double lo[4] = {0, 0, 0, 0}, hi[4] = {0, 0, 0, 0};

  Interval operator[](int c) const { return {lo[c], hi[c]}; }
  void set(int c, Interval range) { lo[c] = range.lo, hi[c] = range.hi; }
};
// Of a net and of the control points of its first and second derivatives.
struct DifferenceRanges {
  ComponentRanges value, a, b, aa, ab, bb;
};

// Of numbers that lie side by side.
Interval value_range(const double* values, std::size_t count);
// Ranges of the control points' X / W, Y / W and Z / W; needs all W > 0.
ComponentRanges ratio_ranges(const Net& net);
DifferenceRanges difference_ranges(const Net& net);
// Of Y - y W in the place of Y; second differences are left out.
DifferenceRanges first_difference_ranges(const Net& net, double y);

// Bounds of y = Y / W, whose own range is given, and of its first derivatives; needs all W > 0.
QuotientBounds slope_bounds(const Net& net, Interval y);

// Bounds over the net of x = X/W, y = Y/W and key = Z/W; needs all W > 0. All follow from the convex hull property of
// the control points and of their first and second differences.
struct NetBounds {
  QuotientBounds x, y, key;
  // For a parameter step (da, db) not larger than h, X - x W, Y - y W and Z - key W, for any x, y and key in the net's
  // range and taken over W, differ from their linear parts by at most this times h^2.
  double x_remainder, y_remainder, key_remainder;
  explicit NetBounds(const Net& net) : NetBounds(net, ratio_ranges(net)) {}
  // range: the net's ratio_ranges.
  NetBounds(const Net& net, const ComponentRanges& range);
};
// Convex hull bound of numerator / denominator; the denominator must be positive at every control point.
Interval hull_range(const Net& net, Component numerator, Component denominator);

}  // namespace nofacet
