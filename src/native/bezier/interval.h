// Closed intervals for certificates: bounds that hold over a whole piece, not at samples.
#pragma once
#include <algorithm>
#include <cmath>

namespace nofacet {

struct Interval {
  double lo = 0.0, hi = 0.0;

  static Interval empty() { return {INFINITY, -INFINITY}; }
  void include(double x) {
    lo = std::min(lo, x);
    hi = std::max(hi, x);
  }
  double width() const { return hi - lo; }
  double mid() const { return 0.5 * (lo + hi); }
  double magnitude() const { return std::max(std::fabs(lo), std::fabs(hi)); }
  // Smallest absolute value in the interval; 0 if it contains zero.
  double mignitude() const { return lo > 0 ? lo : hi < 0 ? -hi : 0.0; }
  bool positive() const { return lo > 0; }
  bool one_signed() const { return lo > 0 || hi < 0; }
};

inline Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
inline Interval operator-(Interval a, Interval b) { return {a.lo - b.hi, a.hi - b.lo}; }
inline Interval operator-(Interval a) { return {-a.hi, -a.lo}; }
inline Interval operator-(Interval a, double b) { return {a.lo - b, a.hi - b}; }
inline Interval operator*(Interval a, double s) {
  return s >= 0 ? Interval{a.lo * s, a.hi * s} : Interval{a.hi * s, a.lo * s};
}
inline Interval operator*(Interval a, Interval b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return {std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s))};
}
// b must not contain zero.
inline Interval operator/(Interval a, Interval b) { return a * Interval{1.0 / b.hi, 1.0 / b.lo}; }
inline Interval square(Interval a) {
  const double l = a.lo * a.lo, h = a.hi * a.hi;
  return {a.lo <= 0 && a.hi >= 0 ? 0.0 : std::min(l, h), std::max(l, h)};
}
inline Interval intersect(Interval a, Interval b) { return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)}; }

}  // namespace nofacet
