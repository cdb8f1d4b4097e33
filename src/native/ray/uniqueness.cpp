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

// The bound of a parameter's derivatives over the net, by the quotient rule: of N / W it is (N' - (N / W) W') / W.
// Ranges of N', N / W, W' and W.
Interval quotient_derivative(Interval n, Interval f, Interval dw, Interval w) { return (n - f * dw) / w; }

// Degrees known at compile time let the compiler unroll; -1 means read from the net.
template <int N, int M>
void certify(const Net& net, Uniqueness& result) {
  constexpr int kPoints = N >= 0 ? (N + 1) * (M + 1) : (kMaxDegree + 1) * (kMaxDegree + 1);
  const int n = N >= 0 ? N : net.n, m = M >= 0 ? M : net.m, row = m + 1, size = (n + 1) * row;
  const MiddleBasis &bu = middle_basis(n), &bv = middle_basis(m);
  double p[3] = {0, 0, 0}, pa[3] = {0, 0, 0}, pb[3] = {0, 0, 0};
  double dx[kPoints], dy[kPoints], weight[kPoints];
  for (int i = 0; i <= n; ++i) {
    double sum[3] = {0, 0, 0}, slope[3] = {0, 0, 0};
    for (int j = 0; j <= m; ++j) {
      const double* point = net.points + 4 * (i * row + j);
      weight[i * row + j] = point[kW];
      for (int c = 0; c < 3; ++c) sum[c] += bv.value[j] * point[c], slope[c] += bv.first[j] * point[c];
    }
    for (int c = 0; c < 3; ++c) {
      p[c] += bu.value[i] * sum[c];
      pa[c] += bu.first[i] * sum[c];
      pb[c] += bu.value[i] * slope[c];
    }
  }
  const double r = 1.0 / p[kW], x = p[kX] * r, y = p[kY] * r;
  const double xa = (pa[kX] - x * pa[kW]) * r, ya = (pa[kY] - y * pa[kW]) * r;
  const double xb = (pb[kX] - x * pb[kW]) * r, yb = (pb[kY] - y * pb[kW]) * r;
  const double inverse = 1.0 / (xa * yb - xb * ya);
  result.x = x, result.y = y;
  if (!std::isfinite(inverse)) return;
  double *a = result.a, *b = result.b;
  a[0] = yb * inverse, a[1] = -xb * inverse;
  b[0] = -ya * inverse, b[1] = xa * inverse;

  // (g, h) = A^-1 (X - x W, Y - y W): differences of g and h are those of a and b, times W. One parameter first: most
  // nets that fail do so by it.
  double *g = dx, *h = dy;
  for (int k = 0; k < size; ++k) {
    const double to_x = net.points[4 * k + kX] - x * weight[k], to_y = net.points[4 * k + kY] - y * weight[k];
    g[k] = a[0] * to_x + a[1] * to_y;
    h[k] = b[0] * to_x + b[1] * to_y;
  }
  Interval w = Interval::empty();
  for (int k = 0; k < size; ++k) w.include(weight[k]);
  Interval ga = Interval::empty(), ha = ga;
  for (int k = 0; k + row < size; ++k) ga.include(g[k + row] - g[k]), ha.include(h[k + row] - h[k]);
  ga = ga * n, ha = ha * n;
  const double scale = 1.0 / w.lo;
  const bool rational = w.lo != w.hi;
  if (!rational &&
      ((ga * scale - 1.0).magnitude() > Uniqueness::kLimit || (ha * scale).magnitude() > Uniqueness::kLimit)) {
    return;
  }
  Interval gb = Interval::empty(), hb = gb;
  for (int i = 0; i <= n; ++i) {
    for (int k = i * row; k < i * row + m; ++k) gb.include(g[k + 1] - g[k]), hb.include(h[k + 1] - h[k]);
  }
  gb = gb * m, hb = hb * m;
  if (rational) {
    Interval g_range = Interval::empty(), h_range = g_range, wa = g_range, wb = g_range;
    for (int k = 0; k < size; ++k) {
      const double unit = 1.0 / weight[k];
      g_range.include(g[k] * unit), h_range.include(h[k] * unit);
    }
    for (int k = 0; k + row < size; ++k) wa.include(weight[k + row] - weight[k]);
    for (int i = 0; i <= n; ++i) {
      for (int k = i * row; k < i * row + m; ++k) wb.include(weight[k + 1] - weight[k]);
    }
    wa = wa * n, wb = wb * m;
    ga = quotient_derivative(ga, g_range, wa, w), gb = quotient_derivative(gb, g_range, wb, w);
    ha = quotient_derivative(ha, h_range, wa, w), hb = quotient_derivative(hb, h_range, wb, w);
  } else {
    ga = ga * scale, gb = gb * scale, ha = ha * scale, hb = hb * scale;
  }
  result.q = std::max((ga - 1.0).magnitude() + gb.magnitude(), ha.magnitude() + (hb - 1.0).magnitude());
}

}  // namespace

Uniqueness::Uniqueness(const Net& net) : q(INFINITY) {
  switch (net.n * 64 + net.m) {
    case 1 * 64 + 1:
      certify<1, 1>(net, *this);
      break;
    case 1 * 64 + 2:
      certify<1, 2>(net, *this);
      break;
    case 2 * 64 + 1:
      certify<2, 1>(net, *this);
      break;
    case 2 * 64 + 2:
      certify<2, 2>(net, *this);
      break;
    case 3 * 64 + 3:
      certify<3, 3>(net, *this);
      break;
    default:
      certify<-1, -1>(net, *this);
      break;
  }
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
