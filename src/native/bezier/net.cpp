#include "bezier/net.h"

#include <algorithm>
#include <cstring>

namespace nofacet {

namespace {

// Degrees known at compile time let the compiler unroll; -1 means read from the net.
template <int N, int M>
Jet evaluate_degrees(const Net& net, double a, double b) {
  const int n = N >= 0 ? N : net.n, m = M >= 0 ? M : net.m;
  double ba[kMaxDegree + 1], da[kMaxDegree + 1], bb[kMaxDegree + 1], db[kMaxDegree + 1];
  bernstein_basis(n, a, ba, da);
  bernstein_basis(m, b, bb, db);
  Jet jet{};
  const double* p = net.points;
  for (int i = 0; i <= n; ++i) {
    double row[4] = {0, 0, 0, 0}, slope[4] = {0, 0, 0, 0};
    for (int j = 0; j <= m; ++j, p += 4) {
      for (int c = 0; c < 4; ++c) {
        row[c] += bb[j] * p[c];
        slope[c] += db[j] * p[c];
      }
    }
    for (int c = 0; c < 4; ++c) {
      jet.p[c] += ba[i] * row[c];
      jet.pa[c] += da[i] * row[c];
      jet.pb[c] += ba[i] * slope[c];
    }
  }
  return jet;
}

}  // namespace

Jet evaluate(const Net& net, double a, double b) {
  switch (net.n * 64 + net.m) {
    case 1 * 64 + 1:
      return evaluate_degrees<1, 1>(net, a, b);
    case 1 * 64 + 2:
      return evaluate_degrees<1, 2>(net, a, b);
    case 1 * 64 + 3:
      return evaluate_degrees<1, 3>(net, a, b);
    case 2 * 64 + 1:
      return evaluate_degrees<2, 1>(net, a, b);
    case 2 * 64 + 2:
      return evaluate_degrees<2, 2>(net, a, b);
    case 2 * 64 + 3:
      return evaluate_degrees<2, 3>(net, a, b);
    case 3 * 64 + 1:
      return evaluate_degrees<3, 1>(net, a, b);
    case 3 * 64 + 2:
      return evaluate_degrees<3, 2>(net, a, b);
    case 3 * 64 + 3:
      return evaluate_degrees<3, 3>(net, a, b);
    default:
      return evaluate_degrees<-1, -1>(net, a, b);
  }
}

void evaluate_mixed(const Net& net, double a, double b, double mixed[4]) {
  double ba[kMaxDegree + 1], da[kMaxDegree + 1], bb[kMaxDegree + 1], db[kMaxDegree + 1];
  bernstein_basis(net.n, a, ba, da);
  bernstein_basis(net.m, b, bb, db);
  std::fill(mixed, mixed + 4, 0.0);
  const double* p = net.points;
  for (int i = 0; i <= net.n; ++i) {
    for (int j = 0; j <= net.m; ++j, p += 4) {
      for (int c = 0; c < 4; ++c) mixed[c] += da[i] * db[j] * p[c];
    }
  }
}

namespace {

// de Casteljau at t along one direction of the net: `count` lines of `n` + 1 points, `stride` apart inside a line.
void casteljau(const double* in, double* left, double* right, int n, int count, int line, int stride, double t) {
  for (int k = 0; k < count; ++k) {
    double work[4 * (kMaxDegree + 1)];
    for (int i = 0; i <= n; ++i) std::memcpy(work + 4 * i, in + 4 * (k * line + i * stride), 4 * sizeof(double));
    auto store = [&](double* out, int index, int from) {
      std::memcpy(out + 4 * (k * line + index * stride), work + 4 * from, 4 * sizeof(double));
    };
    if (left) store(left, 0, 0);
    if (right) store(right, n, n);
    for (int level = 1; level <= n; ++level) {
      const int end = 4 * (n - level + 1);
      if (t == 0.5) {
        for (int i = 0; i < end; ++i) work[i] = 0.5 * (work[i] + work[i + 4]);
      } else {
        for (int i = 0; i < end; ++i) work[i] = (1.0 - t) * work[i] + t * work[i + 4];
      }
      if (left) store(left, level, 0);
      if (right) store(right, n - level, n - level);
    }
  }
}

}  // namespace

void split_a(const Net& net, double* left, double* right) {
  casteljau(net.points, left, right, net.n, net.m + 1, 1, net.m + 1, 0.5);
}

void split_b(const Net& net, double* left, double* right) {
  casteljau(net.points, left, right, net.m, net.n + 1, net.m + 1, 1, 0.5);
}

void restrict_net(const Net& net, double a0, double a1, double b0, double b1, double* out) {
  const int row = net.m + 1;
  if (out != net.points) std::memcpy(out, net.points, net.size() * sizeof(double));
  if (a1 < 1.0) casteljau(out, out, nullptr, net.n, row, 1, row, a1);
  if (a0 > 0.0) casteljau(out, nullptr, out, net.n, row, 1, row, a0 / a1);
  if (b1 < 1.0) casteljau(out, out, nullptr, net.m, net.n + 1, row, 1, b1);
  if (b0 > 0.0) casteljau(out, nullptr, out, net.m, net.n + 1, row, 1, b0 / b1);
}

void transpose(const Net& net, double* out) {
  for (int i = 0; i <= net.n; ++i) {
    for (int j = 0; j <= net.m; ++j) std::memcpy(out + 4 * (j * (net.n + 1) + i), net.at(i, j), 4 * sizeof(double));
  }
}

Interval hull_range(const Net& net, Component numerator, Component denominator) {
  Interval range = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4)
    range.include(p[numerator] / p[denominator]);
  return range;
}

namespace {

struct Differences {
  Interval a{}, b{}, aa{}, ab{}, bb{};
};

// Ranges of the control points of the derivatives of (component c - centre * component w).
Differences differences(const Net& net, int c, int w, double centre) {
  const int n = net.n, m = net.m;
  double value[(kMaxDegree + 1) * (kMaxDegree + 1)];
  const int size = (n + 1) * (m + 1), row = m + 1;
  for (int k = 0; k < size; ++k) value[k] = net.points[4 * k + c] - centre * net.points[4 * k + w];
  Interval a = Interval::empty(), b = a, aa = a, ab = a, bb = a;
  for (int i = 0; i <= n; ++i) {
    const double* v = value + i * row;
    for (int j = 0; j <= m; ++j) {
      if (i < n) a.include(v[j + row] - v[j]);
      if (j < m) b.include(v[j + 1] - v[j]);
      if (i + 1 < n) aa.include(v[j + 2 * row] - 2 * v[j + row] + v[j]);
      if (j + 1 < m) bb.include(v[j + 2] - 2 * v[j + 1] + v[j]);
      if (i < n && j < m) ab.include((v[j + row + 1] - v[j + row]) - (v[j + 1] - v[j]));
    }
  }
  Differences d;
  if (n > 0) d.a = a * n;
  if (m > 0) d.b = b * m;
  if (n > 1) d.aa = aa * (n * (n - 1));
  if (m > 1) d.bb = bb * (m * (m - 1));
  if (n > 0 && m > 0) d.ab = ab * (n * m);
  return d;
}

QuotientBounds quotient(Interval f, double centre, const Differences& num, Interval w, const Differences& den) {
  // f - centre = N / D with N = numerator - centre * D; differentiate N = (f - centre) D.
  const Interval g = f - centre;
  QuotientBounds q;
  q.f = f;
  q.fa = (num.a - g * den.a) / w;
  q.fb = (num.b - g * den.b) / w;
  q.faa = (num.aa - q.fa * den.a * 2.0 - g * den.aa) / w;
  q.fbb = (num.bb - q.fb * den.b * 2.0 - g * den.bb) / w;
  q.fab = (num.ab - q.fa * den.b - q.fb * den.a - g * den.ab) / w;
  return q;
}

Interval component_range(const Net& net, int c) {
  Interval range = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) range.include(p[c]);
  return range;
}

}  // namespace

NetBounds::NetBounds(const Net& net) {
  const Interval w = component_range(net, kW);
  const Differences den = w.lo == w.hi ? Differences{} : differences(net, kW, kW, 0.0);
  const Interval xr = hull_range(net, kX, kW), yr = hull_range(net, kY, kW);
  x = quotient(xr, xr.mid(), differences(net, kX, kW, xr.mid()), w, den);
  y = quotient(yr, yr.mid(), differences(net, kY, kW, yr.mid()), w, den);
}

QuotientBounds quotient_bounds(const Net& net, Component numerator, Component denominator) {
  const Interval w = component_range(net, denominator);
  const Differences den = w.lo == w.hi ? Differences{} : differences(net, denominator, denominator, 0.0);
  const Interval f = hull_range(net, numerator, denominator);
  return quotient(f, f.mid(), differences(net, numerator, denominator, f.mid()), w, den);
}

}  // namespace nofacet
