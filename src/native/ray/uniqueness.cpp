#include "ray/uniqueness.h"

#include <array>
#include <cmath>

namespace nofacet {
namespace {

// Bernstein basis of every degree at 1/2 with its first and second derivatives.
struct MiddleBasis {
  double value[kMaxDegree + 1], first[kMaxDegree + 1], second[kMaxDegree + 1];
};

std::array<MiddleBasis, kMaxDegree + 1> middle_bases() {
  std::array<MiddleBasis, kMaxDegree + 1> table{};
  for (int n = 0; n <= kMaxDegree; ++n) {
    MiddleBasis& basis = table[n];
    bernstein_basis(n, 0.5, basis.value, basis.first);
    if (n < 2) continue;
    double lower[kMaxDegree + 1];
    bernstein_basis(n - 2, 0.5, lower);
    for (int i = 0; i <= n - 2; ++i) {
      for (int k = 0; k < 3; ++k) basis.second[i + k] += n * (n - 1) * lower[i] * (k == 1 ? -2 : 1);
    }
  }
  return table;
}

const MiddleBasis& middle_basis(int n) {
  static const std::array<MiddleBasis, kMaxDegree + 1> table = middle_bases();
  return table[n];
}

}  // namespace

Uniqueness::Uniqueness(const Net& net) : q(INFINITY) {
  const int n = net.n, m = net.m;
  const MiddleBasis &bu = middle_basis(n), &bv = middle_basis(m);
  double p[3] = {0, 0, 0}, pa[3] = {0, 0, 0}, pb[3] = {0, 0, 0};
  Interval w = Interval::empty();
  for (int i = 0; i <= n; ++i) {
    double row[3] = {0, 0, 0}, slope[3] = {0, 0, 0};
    for (int j = 0; j <= m; ++j) {
      const double* point = net.at(i, j);
      w.include(point[kW]);
      for (int c = 0; c < 3; ++c) row[c] += bv.value[j] * point[c], slope[c] += bv.first[j] * point[c];
    }
    for (int c = 0; c < 3; ++c) {
      p[c] += bu.value[i] * row[c];
      pa[c] += bu.first[i] * row[c];
      pb[c] += bu.value[i] * slope[c];
    }
  }
  const double r = 1.0 / p[kW];
  x = p[kX] * r, y = p[kY] * r;
  const double xa = (pa[kX] - x * pa[kW]) * r, ya = (pa[kY] - y * pa[kW]) * r;
  const double xb = (pb[kX] - x * pb[kW]) * r, yb = (pb[kY] - y * pb[kW]) * r;
  const double inverse = 1.0 / (xa * yb - xb * ya);
  if (!std::isfinite(inverse)) return;
  a[0] = yb * inverse, a[1] = -xb * inverse;
  b[0] = -ya * inverse, b[1] = xa * inverse;

  // With (g, h) = A^-1 (X - x W, Y - y W): differences of g and h are those of a and b, times W.
  double g[(kMaxDegree + 1) * (kMaxDegree + 1)], h[(kMaxDegree + 1) * (kMaxDegree + 1)];
  const int row = m + 1, size = (n + 1) * row;
  Interval g_range = Interval::empty(), h_range = g_range;
  for (int k = 0; k < size; ++k) {
    const double* point = net.points + 4 * k;
    const double dx = point[kX] - x * point[kW], dy = point[kY] - y * point[kW];
    g[k] = a[0] * dx + a[1] * dy;
    h[k] = b[0] * dx + b[1] * dy;
  }
  Interval ga = Interval::empty(), gb = ga, ha = ga, hb = ga, wa{0, 0}, wb{0, 0};
  for (int k = 0; k + row < size; ++k) ga.include(g[k + row] - g[k]), ha.include(h[k + row] - h[k]);
  for (int i = 0; i <= n; ++i) {
    for (int k = i * row; k < i * row + m; ++k) gb.include(g[k + 1] - g[k]), hb.include(h[k + 1] - h[k]);
  }
  ga = ga * n, ha = ha * n, gb = gb * m, hb = hb * m;
  if (w.lo != w.hi) {
    // Quotient rule: the derivative of N / W is (N' - (N / W) W') / W.
    for (int k = 0; k < size; ++k) {
      const double weight = net.points[4 * k + kW];
      g_range.include(g[k] / weight), h_range.include(h[k] / weight);
      if (k + row < size) wa.include(net.points[4 * (k + row) + kW] - weight);
      if (k % row < m) wb.include(net.points[4 * (k + 1) + kW] - weight);
    }
    wa = wa * n, wb = wb * m;
    ga = (ga - g_range * wa) / w, gb = (gb - g_range * wb) / w;
    ha = (ha - h_range * wa) / w, hb = (hb - h_range * wb) / w;
  } else {
    const double scale = 1.0 / w.lo;
    ga = ga * scale, gb = gb * scale, ha = ha * scale, hb = hb * scale;
  }
  q = std::max((ga - 1.0).magnitude() + gb.magnitude(), ha.magnitude() + (hb - 1.0).magnitude());
}

InverseCurvature::InverseCurvature(const Net& net, const Uniqueness& linear) {
  const MiddleBasis &bu = middle_basis(net.n), &bv = middle_basis(net.m);
  // Of N = (X - x W, Y - y W) and of W: value, first and second derivatives in the middle.
  double aa[3] = {0, 0, 0}, ab[3] = {0, 0, 0}, bb[3] = {0, 0, 0}, w = 0, wa = 0, wb = 0;
  for (int i = 0; i <= net.n; ++i) {
    for (int j = 0; j <= net.m; ++j) {
      const double* p = net.at(i, j);
      const double value[3] = {p[kX] - linear.x * p[kW], p[kY] - linear.y * p[kW], p[kW]};
      for (int c = 0; c < 2; ++c) {
        aa[c] += bu.second[i] * bv.value[j] * value[c];
        ab[c] += bu.first[i] * bv.first[j] * value[c];
        bb[c] += bu.value[i] * bv.second[j] * value[c];
      }
      w += bu.value[i] * bv.value[j] * p[kW];
      wa += bu.first[i] * bv.value[j] * p[kW];
      wb += bu.value[i] * bv.first[j] * p[kW];
    }
  }
  // N = f W with f = 0 in the middle, so N_aa = f_aa W + 2 f_a W_a. After A^-1, f_a = (1, 0) and f_b = (0, 1).
  const double* rows[2] = {linear.a, linear.b};
  double* out[2] = {a, b};
  for (int k = 0; k < 2; ++k) {
    const double *inverse = rows[k], fa = k == 0, fb = k == 1;
    out[k][0] = 0.5 * ((inverse[0] * aa[0] + inverse[1] * aa[1]) - 2.0 * fa * wa) / w;
    out[k][1] = ((inverse[0] * ab[0] + inverse[1] * ab[1]) - fa * wb - fb * wa) / w;
    out[k][2] = 0.5 * ((inverse[0] * bb[0] + inverse[1] * bb[1]) - 2.0 * fb * wb) / w;
  }
}

}  // namespace nofacet
