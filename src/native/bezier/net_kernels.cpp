// Evaluating nets, splitting them and bounding their derivatives, compiled once for every instruction set that Highway
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

// de Casteljau at t on degree + 1 points, `stride` values apart, of which a vector holds up to Lanes(d) values each.
template <class D>
HWY_INLINE void split_points(D d, const double* in, int degree, std::size_t stride, double t, double* left,
                             double* right) {
  const auto before = hn::Set(d, 1.0 - t), after = hn::Set(d, t);
  hn::Vec<D> p[kMaxPolynomial + 1];
  for (int i = 0; i <= degree; ++i) p[i] = hn::LoadU(d, in + i * stride);
  for (int level = 0;; ++level) {
    hn::StoreU(p[0], d, left + level * stride);
    if (level == degree) break;
    for (int i = 0; i < degree - level; ++i) p[i] = hn::MulAdd(after, p[i + 1], hn::Mul(before, p[i]));
  }
  for (int i = 0; i <= degree; ++i) hn::StoreU(p[i], d, right + i * stride);
}

// The degrees that are met most, known when this is compiled, stay in registers.
template <class D>
HWY_INLINE void split_vectors(D d, const double* in, int degree, std::size_t stride, double t, double* left,
                              double* right) {
  switch (degree) {
    case 1:
      return split_points(d, in, 1, stride, t, left, right);
    case 2:
      return split_points(d, in, 2, stride, t, left, right);
    case 3:
      return split_points(d, in, 3, stride, t, left, right);
    case 5:
      return split_points(d, in, 5, stride, t, left, right);
    default:
      return split_points(d, in, degree, stride, t, left, right);
  }
}

// The same for points of `count` values, side by side.
void split_wide_points(const double* in, int degree, int count, double t, double* left, double* right) {
  const hn::CappedTag<double, 8> wide;
  const int width = int(hn::Lanes(wide));
  if (count < width) {
    const hn::CappedTag<double, 1> one;
    for (int k = 0; k < count; ++k) split_vectors(one, in + k, degree, count, t, left + k, right + k);
    return;
  }
  // The last vector may overlap the one before: the same values are made twice.
  for (int k = 0;; k = std::min(k + width, count - width)) {
    split_vectors(wide, in + k, degree, count, t, left + k, right + k);
    if (k + width == count) return;
  }
}

// The same for points of one value: all of them in one vector, if they are not too many.
void split_values(const double* in, int degree, double t, double* left, double* right) {
  const hn::CappedTag<double, 8> d;
  const hn::RebindToSigned<decltype(d)> i;
  const int width = int(hn::Lanes(d));
  if (degree >= width) return split_points(hn::CappedTag<double, 1>(), in, degree, 1, t, left, right);
  const auto next_lane = hn::Min(hn::Iota(i, 1), hn::Set(i, width - 1));
  const auto next = hn::IndicesFromVec(d, next_lane);
  const auto before = hn::Set(d, 1.0 - t), after = hn::Set(d, t);
  auto v = hn::MaskedLoad(hn::FirstN(d, degree + 1), d, in);
  left[0] = hn::GetLane(v);
  for (int level = 1; level <= degree; ++level) {
    const auto mean = hn::MulAdd(after, hn::TableLookupLanes(v, next), hn::Mul(before, v));
    v = hn::IfThenElse(hn::FirstN(d, degree + 1 - level), mean, v);
    left[level] = hn::GetLane(v);
  }
  hn::BlendedStore(v, hn::FirstN(d, degree + 1), d, right);
}

void Split(const double* in, int n, int m, int components, bool along_a, double t, double* left, double* right) {
  const int row = components * (m + 1);
  if (along_a) return split_wide_points(in, n, row, t, left, right);
  for (int i = 0; i <= n; ++i, in += row, left += row, right += row) {
    if (components == 1) {
      split_values(in, m, t, left, right);
    } else {
      const Four four;
      for (std::size_t part = 0; part < 4; part += hn::Lanes(four)) {
        split_vectors(four, in + part, m, 4, t, left + part, right + part);
      }
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

HWY_EXPORT(Split);
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

void split_net(const double* in, int n, int m, int components, bool along_a, double t, double* left, double* right) {
  HWY_DYNAMIC_DISPATCH(Split)(in, n, m, components, along_a, t, left, right);
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
