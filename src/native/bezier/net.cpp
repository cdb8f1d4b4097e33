#include "bezier/net.h"

#include <algorithm>
#include <cstring>

namespace nofacet {

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

// f - centre = N / D with N = numerator - centre * D; differentiate N = (f - centre) D.
QuotientBounds first_order(const DifferenceRanges& d, int c, Interval f) {
  const Interval g = f - f.mid(), w = d.value[kW];
  QuotientBounds q;
  q.f = f;
  if (w.lo == 1.0 && w.hi == 1.0) {
    q.fa = d.a[c], q.fb = d.b[c];
  } else {
    q.fa = (d.a[c] - g * d.a[kW]) / w;
    q.fb = (d.b[c] - g * d.b[kW]) / w;
  }
  return q;
}

QuotientBounds quotient(const DifferenceRanges& d, int c, Interval f) {
  const Interval g = f - f.mid(), w = d.value[kW];
  QuotientBounds q = first_order(d, c, f);
  if (w.lo == 1.0 && w.hi == 1.0) {
    q.faa = d.aa[c], q.fab = d.ab[c], q.fbb = d.bb[c];
    return q;
  }
  q.faa = (d.aa[c] - q.fa * d.a[kW] * 2.0 - g * d.aa[kW]) / w;
  q.fbb = (d.bb[c] - q.fb * d.b[kW] * 2.0 - g * d.bb[kW]) / w;
  q.fab = (d.ab[c] - q.fa * d.b[kW] - q.fb * d.a[kW] - g * d.ab[kW]) / w;
  return q;
}

double remainder(const DifferenceRanges& d, int c, double reach) {
  const auto size = [&](const ComponentRanges& second) {
    return second[c].magnitude() + reach * second[kW].magnitude();
  };
  return 0.5 * (size(d.aa) + 2.0 * size(d.ab) + size(d.bb)) / d.value[kW].lo;
}

}  // namespace

QuotientBounds slope_bounds(const Net& net, Interval y) {
  return first_order(first_difference_ranges(net, y.mid()), kY, y);
}

NetBounds::NetBounds(const Net& net, const ComponentRanges& range) {
  // Relative to the middle of the range, where the quotient rule's terms are smallest.
  double shifted[4 * (kMaxDegree + 1) * (kMaxDegree + 1)];
  for (std::size_t k = 0; k < net.size(); k += 4) {
    const double* p = net.points + k;
    for (const int c : {kX, kY, kZ}) shifted[k + c] = p[c] - range[c].mid() * p[kW];
    shifted[k + kW] = p[kW];
  }
  const DifferenceRanges differences = difference_ranges({net.n, net.m, shifted});
  x = quotient(differences, kX, range[kX]);
  y = quotient(differences, kY, range[kY]);
  key = quotient(differences, kZ, range[kZ]);
  x_remainder = remainder(differences, kX, 0.5 * range[kX].width());
  y_remainder = remainder(differences, kY, 0.5 * range[kY].width());
  key_remainder = remainder(differences, kZ, 0.5 * range[kZ].width());
}

}  // namespace nofacet
