// Univariate polynomials in Bernstein form: evaluation, subdivision, and all roots by Bezier clipping.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>

namespace nofacet {

// Highest degree of a patch or trim curve in one parameter (OpenCascade's own limit is 25).
inline constexpr int kMaxDegree = 32;
// Highest degree of a polynomial made from one (the turning points of a rational curve: 2 * 25 - 1).
inline constexpr int kMaxPolynomial = 64;

// Bernstein basis of degree n at t.
inline void bernstein_basis(int n, double t, double* basis) {
  const double s = 1.0 - t;
  basis[0] = 1.0;
  for (int k = 1; k <= n; ++k) {
    double carry = 0.0;
    for (int i = 0; i < k; ++i) {
      const double b = basis[i];
      basis[i] = carry + s * b;
      carry = t * b;
    }
    basis[k] = carry;
  }
}

// Bernstein basis of degree n and its derivative at t.
inline void bernstein_basis(int n, double t, double* basis, double* derivative) {
  const double s = 1.0 - t;
  switch (n) {
    case 0:
      basis[0] = 1.0;
      derivative[0] = 0.0;
      return;
    case 1:
      basis[0] = s, basis[1] = t;
      derivative[0] = -1.0, derivative[1] = 1.0;
      return;
    case 2:
      basis[0] = s * s, basis[1] = 2 * s * t, basis[2] = t * t;
      derivative[0] = -2 * s, derivative[1] = 2 * (s - t), derivative[2] = 2 * t;
      return;
    case 3: {
      const double ss = s * s, tt = t * t, st = s * t;
      basis[0] = ss * s, basis[1] = 3 * ss * t, basis[2] = 3 * s * tt, basis[3] = tt * t;
      derivative[0] = -3 * ss, derivative[1] = 3 * (ss - 2 * st), derivative[2] = 3 * (2 * st - tt);
      derivative[3] = 3 * tt;
      return;
    }
    default: {
      double lower[kMaxPolynomial + 1];
      bernstein_basis(n - 1, t, lower);
      basis[0] = s * lower[0];
      derivative[0] = -n * lower[0];
      for (int i = 1; i < n; ++i) {
        basis[i] = s * lower[i] + t * lower[i - 1];
        derivative[i] = n * (lower[i - 1] - lower[i]);
      }
      basis[n] = t * lower[n - 1];
      derivative[n] = n * lower[n - 1];
    }
  }
}

// Value of sum c_i B_i^n(t), and its derivative.
inline double bernstein_value(const double* c, int n, double t, double* slope = nullptr) {
  const double s = 1.0 - t;
  if (n == 1) {
    if (slope) *slope = c[1] - c[0];
    return s * c[0] + t * c[1];
  }
  if (n == 2) {
    const double p = s * c[0] + t * c[1], q = s * c[1] + t * c[2];
    if (slope) *slope = 2.0 * (q - p);
    return s * p + t * q;
  }
  if (n == 3) {
    const double p = s * c[0] + t * c[1], q = s * c[1] + t * c[2], r = s * c[2] + t * c[3];
    const double pq = s * p + t * q, qr = s * q + t * r;
    if (slope) *slope = 3.0 * (qr - pq);
    return s * pq + t * qr;
  }
  double basis[kMaxPolynomial + 1], derivative[kMaxPolynomial + 1];
  bernstein_basis(n, t, basis, derivative);
  double value = 0.0, d = 0.0;
  for (int i = 0; i <= n; ++i) {
    value += basis[i] * c[i];
    d += derivative[i] * c[i];
  }
  if (slope) *slope = d;
  return value;
}

// Coefficients of the polynomial on [0, t] and on [t, 1] (de Casteljau).
inline void bernstein_split(const double* c, int n, double t, double* left, double* right) {
  double work[kMaxPolynomial + 1];
  std::memcpy(work, c, sizeof(double) * (n + 1));
  left[0] = work[0];
  right[n] = work[n];
  for (int k = 1; k <= n; ++k) {
    for (int i = 0; i <= n - k; ++i) work[i] += t * (work[i + 1] - work[i]);
    left[k] = work[0];
    right[n - k] = work[n - k];
  }
}

// Sign changes along the coefficients; zero counts as positive, here and wherever a root is assigned to a side.
inline int sign_variations(const double* c, int n) {
  int count = 0;
  for (int i = 1; i <= n; ++i) count += (c[i] < 0) != (c[i - 1] < 0);
  return count;
}

// A Newton step this small (in units of the bracket) is the last: at a simple root the error is its square.
inline constexpr double kLastNewtonStep = 1e-10;

// The root inside [lo, hi] of a function with opposite signs there: Newton kept inside the bracket, else bisection.
// f(t, &slope) returns the value. Simple roots are found to rounding, multiple ones to 1e-10 of the bracket.
template <class F>
double bracketed_newton(F&& f, double lo, double hi, bool rising, double guess) {
  const double last_step = kLastNewtonStep * (hi - lo), resolution = 1e-16 * std::max(std::fabs(lo), std::fabs(hi));
  double t = guess > lo && guess < hi ? guess : 0.5 * (lo + hi);
  double last_width = hi - lo;
  for (int iteration = 0; iteration < 100; ++iteration) {
    double slope;
    const double value = f(t, &slope);
    if (value == 0.0) return t;
    ((value < 0) == rising ? lo : hi) = t;
    double next = t - value / slope;
    // Newton must stay inside the bracket and shrink it, or end soon; otherwise bisect.
    const bool newton = next > lo && next < hi && (iteration <= 8 || hi - lo <= 0.5 * last_width);
    if (newton && std::fabs(next - t) <= last_step) return next;
    if (!newton) next = 0.5 * (lo + hi);
    if (hi - lo <= resolution) return next;
    last_width = hi - lo;
    t = next;
  }
  return t;
}

// The part of [0, 1] in which the control polygon's convex hull meets the t axis (METHODS: Bezier clipping, Nishita,
// Sederberg, Kakimoto 1990). Returns false if it does not meet.
inline bool hull_clip(const double* c, int n, double* t_min, double* t_max) {
  double lo = 2.0, hi = -1.0;
  for (int i = 0; i <= n; ++i) {
    if (c[i] == 0.0) {
      lo = std::min(lo, double(i) / n);
      hi = std::max(hi, double(i) / n);
    }
    for (int k = i + 1; k <= n; ++k) {
      if ((c[i] < 0) == (c[k] < 0)) continue;
      const double t = (i + (k - i) * (c[i] / (c[i] - c[k]))) / n;
      lo = std::min(lo, t);
      hi = std::max(hi, t);
    }
  }
  *t_min = lo;
  *t_max = hi;
  return lo <= hi;
}

// All roots in [0, 1] at which the polynomial changes sign, ascending. `roots` must hold n values. Returns their
// number. Touching (double) roots without a sign change are not
// reported, because they bound nothing.
inline int bernstein_roots(const double* c, int n, double* roots, double offset = 0.0, double length = 1.0) {
  const int variations = sign_variations(c, n);
  if (variations == 0) return 0;
  if (variations == 1) {
    const double guess = c[0] / (c[0] - c[n]);
    const double t = bracketed_newton([&](double s, double* slope) { return bernstein_value(c, n, s, slope); }, 0.0,
                                      1.0, c[0] < 0, guess);
    roots[0] = offset + length * t;
    return 1;
  }
  if (length < 1e-14) {  // a cluster narrower than the arithmetic: one sign change or none
    if ((c[0] < 0) == (c[n] < 0)) return 0;
    roots[0] = offset + 0.5 * length;
    return 1;
  }
  double t_min, t_max, left[kMaxPolynomial + 1], right[kMaxPolynomial + 1];
  hull_clip(c, n, &t_min, &t_max);
  if (t_max - t_min < 0.8) {
    // Cut both ends off, with a margin of rounding, and go on inside.
    const double lo = std::max(0.0, t_min - 1e-14), hi = std::min(1.0, t_max + 1e-14);
    if (hi < 1.0) {
      bernstein_split(c, n, hi, left, right);
    } else {
      std::memcpy(left, c, sizeof(double) * (n + 1));
    }
    double middle[kMaxPolynomial + 1];
    if (lo > 0.0) {
      bernstein_split(left, n, lo / hi, right, middle);
    } else {
      std::memcpy(middle, left, sizeof(double) * (n + 1));
    }
    return bernstein_roots(middle, n, roots, offset + length * lo, length * (hi - lo));
  }
  bernstein_split(c, n, 0.5, left, right);
  const int first = bernstein_roots(left, n, roots, offset, 0.5 * length);
  return first + bernstein_roots(right, n, roots + first, offset + 0.5 * length, 0.5 * length);
}

}  // namespace nofacet
