// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/cut_kernels.cpp"
#include "raster/cut_kernels.h"

#include "hwy/foreach_target.h"
#include "raster/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMaxNewton = 12;

// Homogeneous point and derivative of a curve.
template <int kDegree>
HWY_INLINE void evaluate_curve_lanes(Lanes d, const double* points, std::size_t stride, int degree, Vec t, Vec p[4],
                                     Vec slope[4]) {
  LaneBasis<kDegree> basis;
  basis.set(d, degree, t);
  for (int c = 0; c < 4; ++c) p[c] = slope[c] = hn::Zero(d);
  for (int i = 0; i <= (kDegree >= 0 ? kDegree : degree); ++i, points += stride) {
    const Vec v = basis.value_at(d, i), s = basis.slope_at(d, i);
    for (int c = 0; c < 4; ++c) {
      const Vec q = hn::Set(d, points[c]);
      p[c] = hn::MulAdd(v, q, p[c]);
      slope[c] = hn::MulAdd(s, q, slope[c]);
    }
  }
}

template <int kDegree>
void BorderRootsOf(const double* points, std::size_t stride, int degree, std::size_t count, PlaneRoots& roots) {
  const Lanes d;
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0), enough = hn::Set(d, kRootStep);
  const double* last = points + degree * stride;
  const double y0 = points[kY] / points[kW], y1 = last[kY] / last[kW];
  const Vec from = hn::Set(d, y0), slope = hn::Set(d, 1.0 / (y1 - y0));
  // The guess is the cubic in y with the border's own slopes at both ends, if it is monotone.
  const auto rate = [&](const double* end, const double* next, double sign) {
    const double by_t = sign * degree * (next[kY] - end[kY] * (next[kW] / end[kW])) / end[kW];
    const double rate = (y1 - y0) / by_t;
    return rate >= 0.0 && rate <= 3.0 ? rate : 1.0;
  };
  const double r0 = rate(points, points + stride, 1.0), r1 = rate(last, last - stride, -1.0);
  const Vec c1 = hn::Set(d, r0), c2 = hn::Set(d, 3.0 - 2.0 * r0 - r1), c3 = hn::Set(d, r0 + r1 - 2.0);
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const Vec y = hn::LoadU(d, roots.y.data() + k);
    Vec t = hn::Min(hn::Max(hn::Mul(hn::Sub(y, from), slope), zero), one);
    if (kDegree != 1) t = hn::Mul(t, hn::MulAdd(t, hn::MulAdd(t, c3, c2), c1));
    for (int iteration = 1;; ++iteration) {
      Vec p[4], dp[4];
      evaluate_curve_lanes<kDegree>(d, points, stride, degree, t, p, dp);
      const Vec residual = hn::NegMulAdd(y, p[kW], p[kY]), rate = hn::NegMulAdd(y, dp[kW], dp[kY]);
      const Vec step = hn::Neg(hn::Div(residual, rate)), size = hn::Abs(step);
      const Vec next = hn::Min(hn::Max(hn::Add(t, step), zero), one);
      if (iteration < kMaxNewton && !hn::AllTrue(d, hn::Lt(size, enough))) {
        t = next;
        continue;
      }
      const Vec moved = hn::Sub(next, t);
      const Vec w = hn::Div(one, hn::MulAdd(moved, dp[kW], p[kW]));
      hn::StoreU(next, d, roots.a.data() + k);
      hn::StoreU(hn::Mul(hn::MulAdd(moved, dp[kX], p[kX]), w), d, roots.x.data() + k);
      hn::StoreU(hn::Mul(hn::MulAdd(moved, dp[kZ], p[kZ]), w), d, roots.key.data() + k);
      hn::StoreU(size, d, roots.step.data() + k);
      break;
    }
  }
}

void BorderRoots(const double* points, std::size_t stride, int degree, std::size_t count, PlaneRoots& roots) {
  switch (degree) {
    case 1:
      return BorderRootsOf<1>(points, stride, degree, count, roots);
    case 2:
      return BorderRootsOf<2>(points, stride, degree, count, roots);
    case 3:
      return BorderRootsOf<3>(points, stride, degree, count, roots);
    default:
      return BorderRootsOf<-1>(points, stride, degree, count, roots);
  }
}

// det(P, Q, R) of homogeneous screen points (X, Y, W).
HWY_INLINE Vec determinant(const Vec p[4], const Vec q[4], const Vec r[4]) {
  const Vec xy = hn::MulSub(q[kX], r[kY], hn::Mul(q[kY], r[kX]));
  const Vec yw = hn::MulSub(q[kY], r[kW], hn::Mul(q[kW], r[kY]));
  const Vec wx = hn::MulSub(q[kW], r[kX], hn::Mul(q[kX], r[kW]));
  return hn::MulAdd(p[kX], yw, hn::MulAdd(p[kY], wx, hn::Mul(p[kW], xy)));
}

struct JacobianSigns {
  const CentredNet& net;
  std::size_t count;
  PlaneRoots& roots;

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    const Lanes d;
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
      LaneJet jet;
      evaluate_lanes<kN, kM, true>(d, net, hn::LoadU(d, roots.a.data() + k), hn::LoadU(d, roots.b.data() + k), jet);
      hn::StoreU(determinant(jet.p, jet.pa, jet.pb), d, roots.step.data() + k);
    }
  }
};

void Jacobians(const CentredNet& net, std::size_t count, PlaneRoots& roots) {
  for_degrees(net.n, net.m, true, JacobianSigns{net, count, roots});
}

struct SecondJet {
  Vec p[4], pa[4], pb[4], paa[4], pab[4], pbb[4];
};

// Horner's rule with second derivatives, on positions relative to the net's centre.
template <int kN, int kM>
HWY_INLINE void evaluate_second(Lanes d, const CentredNet& net, Vec a, Vec b, SecondJet& jet) {
  const int n = kN >= 0 ? kN : net.n, m = kM >= 0 ? kM : net.m;
  const Vec half = hn::Set(d, 0.5), s = hn::Sub(a, half), t = hn::Sub(b, half), zero = hn::Zero(d);
  for (int c = 0; c < 4; ++c) {
    const double* row = net.points + 4 * std::size_t(n) * (m + 1) + c;
    // The second derivatives are halved until the end.
    Vec p = zero, pa = zero, pb = zero, paa = zero, pab = zero, pbb = zero;
    for (int i = n; i >= 0; --i, row -= 4 * (m + 1)) {
      Vec value = hn::Set(d, row[4 * m]), slope = zero, bend = zero;
      for (int j = m - 1; j >= 0; --j) {
        bend = hn::MulAdd(bend, t, slope);
        slope = hn::MulAdd(slope, t, value);
        value = hn::MulAdd(value, t, hn::Set(d, row[4 * j]));
      }
      paa = hn::MulAdd(paa, s, pa);
      pa = hn::MulAdd(pa, s, p);
      p = hn::MulAdd(p, s, value);
      pab = hn::MulAdd(pab, s, pb);
      pb = hn::MulAdd(pb, s, slope);
      pbb = hn::MulAdd(pbb, s, bend);
    }
    jet.p[c] = p, jet.pa[c] = pa, jet.pb[c] = pb;
    jet.paa[c] = hn::Add(paa, paa), jet.pab[c] = pab, jet.pbb[c] = hn::Add(pbb, pbb);
  }
}

// Newton's method on (Y - y W, J) = 0, both in homogeneous form.
struct SolveFolds {
  const CentredNet& net;
  std::size_t count;
  PlaneRoots& roots;

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    const Lanes d;
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) solve<kN, kM>(d, k);
  }

 private:
  template <int kN, int kM>
  HWY_INLINE void solve(Lanes d, std::size_t k) const {
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0), enough = hn::Set(d, kRootStep);
    const Vec y = hn::Sub(hn::LoadU(d, roots.y.data() + k), hn::Set(d, net.y));
    Vec a = hn::LoadU(d, roots.a.data() + k), b = hn::LoadU(d, roots.b.data() + k);
    for (int iteration = 1;; ++iteration) {
      SecondJet jet;
      evaluate_second<kN, kM>(d, net, a, b, jet);
      const Vec f = hn::NegMulAdd(y, jet.p[kW], jet.p[kY]);
      const Vec fa = hn::NegMulAdd(y, jet.pa[kW], jet.pa[kY]), fb = hn::NegMulAdd(y, jet.pb[kW], jet.pb[kY]);
      const Vec j = determinant(jet.p, jet.pa, jet.pb);
      const Vec ja = hn::Add(determinant(jet.p, jet.paa, jet.pb), determinant(jet.p, jet.pa, jet.pab));
      const Vec jb = hn::Add(determinant(jet.p, jet.pab, jet.pb), determinant(jet.p, jet.pa, jet.pbb));
      const Vec inverse = hn::Div(one, hn::MulSub(fa, jb, hn::Mul(fb, ja)));
      const Vec da = hn::Mul(hn::MulSub(fb, j, hn::Mul(f, jb)), inverse);
      const Vec db = hn::Mul(hn::MulSub(f, ja, hn::Mul(fa, j)), inverse);
      const Vec size = hn::Max(hn::Abs(da), hn::Abs(db));
      const Vec next_a = hn::Min(hn::Max(hn::Add(a, da), zero), one),
                next_b = hn::Min(hn::Max(hn::Add(b, db), zero), one);
      if (iteration < kMaxNewton && !hn::AllTrue(d, hn::Lt(size, enough))) {
        a = next_a, b = next_b;
        continue;
      }
      const Vec moved_a = hn::Sub(next_a, a), moved_b = hn::Sub(next_b, b);
      const auto moved = [&](int c) HWY_ATTR {
        return hn::MulAdd(moved_a, jet.pa[c], hn::MulAdd(moved_b, jet.pb[c], jet.p[c]));
      };
      const Vec w = hn::Div(one, moved(kW));
      hn::StoreU(next_a, d, roots.a.data() + k);
      hn::StoreU(next_b, d, roots.b.data() + k);
      hn::StoreU(hn::MulAdd(moved(kX), w, hn::Set(d, net.x)), d, roots.x.data() + k);
      hn::StoreU(hn::MulAdd(moved(kZ), w, hn::Set(d, net.key)), d, roots.key.data() + k);
      hn::StoreU(size, d, roots.step.data() + k);
      break;
    }
  }
};

void FoldRoots(const CentredNet& net, std::size_t count, PlaneRoots& roots) {
  for_degrees(net.n, net.m, true, SolveFolds{net, count, roots});
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(BorderRoots);
HWY_EXPORT(Jacobians);
HWY_EXPORT(FoldRoots);

void PlaneRoots::resize(std::size_t count) {
  const std::size_t size = (count + 7) / 8 * 8;
  if (y.size() >= size) return;
  for (std::vector<double>* list : {&y, &a, &b, &x, &key, &step}) list->resize(size);
}

void PlaneRoots::pad(std::size_t count) {
  for (std::size_t k = count; k % 8 != 0; ++k) y[k] = y[count - 1], a[k] = a[count - 1], b[k] = b[count - 1];
}

void border_roots(const double* points, std::size_t stride, int degree, std::size_t count, PlaneRoots& roots) {
  HWY_DYNAMIC_DISPATCH(BorderRoots)(points, stride, degree, count, roots);
}

void jacobians(const CentredNet& net, std::size_t count, PlaneRoots& roots) {
  HWY_DYNAMIC_DISPATCH(Jacobians)(net, count, roots);
}

void fold_roots(const CentredNet& net, std::size_t count, PlaneRoots& roots) {
  HWY_DYNAMIC_DISPATCH(FoldRoots)(net, count, roots);
}

}  // namespace nofacet
#endif
