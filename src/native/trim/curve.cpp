#include "trim/curve.h"

#include <cmath>

#include "bezier/bernstein.h"

namespace nofacet {

CurvePoint evaluate_curve(const double* points, int degree, double t) {
  double basis[kMaxDegree + 1], slope[kMaxDegree + 1];
  bernstein_basis(degree, t, basis, slope);
  double p[3] = {0, 0, 0}, d[3] = {0, 0, 0};
  for (int i = 0; i <= degree; ++i) {
    for (int c = 0; c < 3; ++c) {
      p[c] += basis[i] * points[3 * i + c];
      d[c] += slope[i] * points[3 * i + c];
    }
  }
  const double u = p[0] / p[2], v = p[1] / p[2];
  return {u, v, (d[0] - u * d[2]) / p[2], (d[1] - v * d[2]) / p[2]};
}

void derivative_bounds(const double* points, int degree, double t0, double t1, Interval* du, Interval* dv) {
  double part[3][kMaxDegree + 1], scratch[kMaxDegree + 1], half[kMaxDegree + 1];
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i <= degree; ++i) scratch[i] = points[3 * i + c];
    bernstein_split(scratch, degree, t1, part[c], half);
    bernstein_split(part[c], degree, t0 / t1, scratch, half);
    for (int i = 0; i <= degree; ++i) part[c][i] = half[i];
  }
  Interval w = Interval::empty(), dw = w;
  for (int i = 0; i <= degree; ++i) w.include(part[2][i]);
  for (int i = 0; i < degree; ++i) dw.include(degree * (part[2][i + 1] - part[2][i]));
  for (int c = 0; c < 2; ++c) {
    Interval f = Interval::empty(), d = f;
    for (int i = 0; i <= degree; ++i) f.include(part[c][i] / part[2][i]);
    const double centre = f.mid();
    for (int i = 0; i < degree; ++i) {
      d.include(degree * ((part[c][i + 1] - centre * part[2][i + 1]) - (part[c][i] - centre * part[2][i])));
    }
    // The hodograph is by the local parameter of [t0, t1]; the division makes it by t.
    *(c == 0 ? du : dv) = ((d - (f - centre) * dw) / w) * (1.0 / (t1 - t0));
  }
}

namespace {

template <class Coordinate>
double parameter_at(const TrimArc& arc, double value, double first, double last, Coordinate coordinate) {
  const double guess = arc.t0 + (arc.t1 - arc.t0) * (value - first) / (last - first);
  if (arc.degree == 1 && arc.points[2] == arc.points[5]) return guess;
  return bracketed_newton(
      [&](double t, double* slope) {
        const CurvePoint p = arc.at(t);
        const auto [x, dx] = coordinate(p);
        *slope = dx;
        return x - value;
      },
      arc.t0, arc.t1, last > first, guess);
}

}  // namespace

double TrimArc::parameter_at_u(double u) const {
  return parameter_at(*this, u, u0, u1, [](const CurvePoint& p) { return std::pair{p.u, p.du}; });
}

double TrimArc::parameter_at_v(double v) const {
  return parameter_at(*this, v, v0, v1, [](const CurvePoint& p) { return std::pair{p.v, p.dv}; });
}

}  // namespace nofacet
