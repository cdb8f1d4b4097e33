// Trim curves: rational Bezier segments in a face's (u, v), cut where they turn so that each arc is monotone in both.
#pragma once
#include "bezier/interval.h"

namespace nofacet {

struct CurvePoint {
  double u, v, du, dv;  // position and derivative by t
};

// Point and derivative of the rational Bezier segment `points` (degree + 1 homogeneous points wu, wv, w) at t.
CurvePoint evaluate_curve(const double* points, int degree, double t);

// Bounds of du/dt and dv/dt over [t0, t1], from the hodograph's control polygon.
void derivative_bounds(const double* points, int degree, double t0, double t1, Interval* du, Interval* dv);

// A part [t0, t1] of a segment along which neither u nor v turns back: its box is spanned by its end points.
struct TrimArc {
  const double* points;
  int degree;
  double t0, t1;
  double u0, v0, u1, v1;
  Interval du, dv;  // bounds of the derivatives by t

  CurvePoint at(double t) const { return evaluate_curve(points, degree, t); }
  Interval u_range() const { return u0 < u1 ? Interval{u0, u1} : Interval{u1, u0}; }
  Interval v_range() const { return v0 < v1 ? Interval{v0, v1} : Interval{v1, v0}; }
  // The parameter in [t0, t1] where u (or v) takes the given value, which must lie between its end values.
  double parameter_at_u(double u) const;
  double parameter_at_v(double v) const;
};

}  // namespace nofacet
