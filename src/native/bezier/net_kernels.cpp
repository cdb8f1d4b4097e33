// Evaluating nets, halving them and bounding their derivatives, compiled once for every instruction set that Highway
// knows of.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bezier/net_kernels.cpp"
#include <algorithm>
#include <cstring>

#include "bezier/net.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Four = hn::CappedTag<double, 4>;  // the components of a point, in one vector or two

// v[k] = (v[k] + v[k + stride]) / 2 for k < count.
HWY_INLINE void average(double* v, int count, int stride) {
  const hn::CappedTag<double, 8> d;
  const auto half = hn::Set(d, 0.5);
  const int width = int(hn::Lanes(d));
  int k = 0;
  for (; k + width <= count; k += width) {
    hn::StoreU(hn::Mul(half, hn::Add(hn::LoadU(d, v + k), hn::LoadU(d, v + k + stride))), d, v + k);
  }
  for (; k < count; ++k) v[k] = 0.5 * (v[k] + v[k + stride]);
}

// de Casteljau at 1/2. What is done in place turns into the right half; the first points of each level make the left.
void Halve(const double* in, int n, int m, int components, bool along_a, double* left, double* right) {
  const int row = components * (m + 1);
  std::memcpy(right, in, sizeof(double) * std::size_t(n + 1) * row);
  if (along_a) {
    std::memcpy(left, right, sizeof(double) * row);
    for (int level = 1; level <= n; ++level) {
      average(right, (n - level + 1) * row, row);
      std::memcpy(left + level * row, right, sizeof(double) * row);
    }
    return;
  }
  for (int i = 0; i <= n; ++i, left += row, right += row) {
    for (int c = 0; c < components; ++c) left[c] = right[c];
    for (int level = 1; level <= m; ++level) {
      average(right, (m - level + 1) * components, components);
      for (int c = 0; c < components; ++c) left[level * components + c] = right[c];
    }
  }
}

using V = hn::Vec<Four>;

// Ranges of the components of several points.
struct Range {
  V lo, hi;

  HWY_INLINE void start(Four d) { lo = hn::Set(d, INFINITY), hi = hn::Set(d, -INFINITY); }
  HWY_INLINE void include(V v) { lo = hn::Min(lo, v), hi = hn::Max(hi, v); }
  HWY_INLINE void store(Four d, std::size_t part, double factor, ComponentRanges& out) const {
    hn::StoreU(hn::Mul(lo, hn::Set(d, factor)), d, out.lo + part);
    hn::StoreU(hn::Mul(hi, hn::Set(d, factor)), d, out.hi + part);
  }
};

void Ratios(const Net& net, ComponentRanges& out) {
  const Four d;
  for (std::size_t part = 0; part < 4; part += hn::Lanes(d)) {
    Range range;
    range.start(d);
    for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
      const V v = hn::LoadU(d, p + part);
      range.include(p[kW] == 1.0 ? v : hn::Div(v, hn::Set(d, p[kW])));
    }
    range.store(d, part, 1.0, out);
  }
}

void Values(const double* values, std::size_t count, Interval& out) {
  const hn::CappedTag<double, 8> d;
  const std::size_t width = hn::Lanes(d);
  if (count < width) {
    for (std::size_t k = 0; k < count; ++k) out.include(values[k]);
    return;
  }
  auto lo = hn::LoadU(d, values), hi = lo;
  for (std::size_t k = width; k < count; k += width) {
    const auto v = hn::LoadU(d, values + std::min(k, count - width));
    lo = hn::Min(lo, v), hi = hn::Max(hi, v);
  }
  out = {hn::GetLane(hn::MinOfLanes(d, lo)), hn::GetLane(hn::MaxOfLanes(d, hi))};
}

void Differences(const Net& net, DifferenceRanges& out) {
  const Four d;
  const int n = net.n, m = net.m, row = 4 * (m + 1);
  for (std::size_t part = 0; part < 4; part += hn::Lanes(d)) {
    const auto at = [&](int i, int j) HWY_ATTR { return hn::LoadU(d, net.points + i * row + 4 * j + part); };
    Range value, a, b, aa, ab, bb;
    value.start(d), a.start(d), b.start(d), aa.start(d), ab.start(d), bb.start(d);
    for (int i = 0; i <= n; ++i) {
      V before_a = hn::Zero(d), before_b = hn::Zero(d);
      for (int j = 0; j <= m; ++j) {
        const V v = at(i, j);
        value.include(v);
        if (i < n) {
          const V da = hn::Sub(at(i + 1, j), v);
          a.include(da);
          if (i + 1 < n) aa.include(hn::Sub(hn::Sub(at(i + 2, j), at(i + 1, j)), da));
          if (j > 0) ab.include(hn::Sub(da, before_a));
          before_a = da;
        }
        if (j < m) {
          const V db = hn::Sub(at(i, j + 1), v);
          b.include(db);
          if (j > 0) bb.include(hn::Sub(db, before_b));
          before_b = db;
        }
      }
    }
    value.store(d, part, 1.0, out.value);
    a.store(d, part, n, out.a), b.store(d, part, m, out.b);
    if (n > 1) aa.store(d, part, n * (n - 1), out.aa);
    if (m > 1) bb.store(d, part, m * (m - 1), out.bb);
    ab.store(d, part, n * m, out.ab);
  }
}

// Of Y - y W instead of Y, and without second differences.
void FirstDifferences(const Net& net, double y, DifferenceRanges& out) {
  const Four d;
  const int n = net.n, m = net.m, row = 4 * (m + 1);
  const double shifts[4] = {0.0, y, 0.0, 0.0};
  for (std::size_t part = 0; part < 4; part += hn::Lanes(d)) {
    const V shift = hn::LoadU(d, shifts + part);
    const auto at = [&](const double* p)
                        HWY_ATTR { return hn::NegMulAdd(shift, hn::Set(d, p[kW]), hn::LoadU(d, p + part)); };
    Range value, a, b;
    value.start(d), a.start(d), b.start(d);
    const double* p = net.points;
    for (int i = 0; i <= n; ++i) {
      V before = hn::Zero(d);
      for (int j = 0; j <= m; ++j, p += 4) {
        const V v = at(p);
        value.include(v);
        if (i < n) a.include(hn::Sub(at(p + row), v));
        if (j > 0) b.include(hn::Sub(v, before));
        before = v;
      }
    }
    value.store(d, part, 1.0, out.value);
    a.store(d, part, n, out.a), b.store(d, part, m, out.b);
  }
}

void Evaluate(const Net& net, double a, double b, Jet& jet) {
  const Four d;
  double in_a[kMaxDegree + 1], by_a[kMaxDegree + 1], in_b[kMaxDegree + 1], by_b[kMaxDegree + 1];
  bernstein_basis(net.n, a, in_a, by_a);
  bernstein_basis(net.m, b, in_b, by_b);
  for (std::size_t part = 0; part < 4; part += hn::Lanes(d)) {
    const double* point = net.points + part;
    V p = hn::Zero(d), pa = p, pb = p;
    for (int i = 0; i <= net.n; ++i) {
      V row = hn::Zero(d), slope = row;
      for (int j = 0; j <= net.m; ++j, point += 4) {
        const V q = hn::LoadU(d, point);
        row = hn::MulAdd(hn::Set(d, in_b[j]), q, row);
        slope = hn::MulAdd(hn::Set(d, by_b[j]), q, slope);
      }
      p = hn::MulAdd(hn::Set(d, in_a[i]), row, p);
      pa = hn::MulAdd(hn::Set(d, by_a[i]), row, pa);
      pb = hn::MulAdd(hn::Set(d, in_a[i]), slope, pb);
    }
    hn::StoreU(p, d, jet.p + part);
    hn::StoreU(pa, d, jet.pa + part);
    hn::StoreU(pb, d, jet.pb + part);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(Halve);
HWY_EXPORT(Ratios);
HWY_EXPORT(Values);
HWY_EXPORT(Differences);
HWY_EXPORT(FirstDifferences);
HWY_EXPORT(Evaluate);

Jet evaluate(const Net& net, double a, double b) {
  Jet jet;
  HWY_DYNAMIC_DISPATCH(Evaluate)(net, a, b, jet);
  return jet;
}

void halve(const double* in, int n, int m, int components, bool along_a, double* left, double* right) {
  HWY_DYNAMIC_DISPATCH(Halve)(in, n, m, components, along_a, left, right);
}

ComponentRanges ratio_ranges(const Net& net) {
  ComponentRanges ranges;
  HWY_DYNAMIC_DISPATCH(Ratios)(net, ranges);
  return ranges;
}

Interval value_range(const double* values, std::size_t count) {
  Interval range = Interval::empty();
  HWY_DYNAMIC_DISPATCH(Values)(values, count, range);
  return range;
}

DifferenceRanges difference_ranges(const Net& net) {
  DifferenceRanges ranges;
  HWY_DYNAMIC_DISPATCH(Differences)(net, ranges);
  return ranges;
}

DifferenceRanges first_difference_ranges(const Net& net, double y) {
  DifferenceRanges ranges;
  HWY_DYNAMIC_DISPATCH(FirstDifferences)(net, y, ranges);
  return ranges;
}

}  // namespace nofacet
#endif
