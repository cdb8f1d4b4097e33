// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface_kernel.cpp"
#include "surface_kernel.h"

#include <algorithm>
#include <array>
#include <limits>

#include "bezier/bernstein.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "patch_normal.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Vec = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;

constexpr int kAnyDegree = -1;

struct Vec3 {
  Vec x, y, z;
};

HWY_INLINE Vec dot(const Vec3& p, const Vec3& q) {
  return hn::MulAdd(p.x, q.x, hn::MulAdd(p.y, q.y, hn::Mul(p.z, q.z)));
}
HWY_INLINE Vec3 cross(const Vec3& p, const Vec3& q) {
  return {hn::MulSub(p.y, q.z, hn::Mul(p.z, q.y)), hn::MulSub(p.z, q.x, hn::Mul(p.x, q.z)),
          hn::MulSub(p.x, q.y, hn::Mul(p.y, q.x))};
}
HWY_INLINE Vec3 scaled(Vec factor, const Vec3& v) {
  return {hn::Mul(factor, v.x), hn::Mul(factor, v.y), hn::Mul(factor, v.z)};
}
// factor_p p + factor_q q
HWY_INLINE Vec3 blend(Vec factor_p, const Vec3& p, Vec factor_q, const Vec3& q) {
  return {hn::MulAdd(factor_p, p.x, hn::Mul(factor_q, q.x)), hn::MulAdd(factor_p, p.y, hn::Mul(factor_q, q.y)),
          hn::MulAdd(factor_p, p.z, hn::Mul(factor_q, q.z))};
}

// Bernstein polynomials of degree n with first and second derivatives, all from those of degree n - 2, or n - 1 below.
template <int N>
struct SecondBasis {
  static constexpr int kSize = (N == kAnyDegree ? kMaxDegree : N) + 1;
  Vec value[kSize], slope[kSize], bend[kSize];

  HWY_INLINE void evaluate(Lanes d, int degree, Vec t) {
    const int n = N == kAnyDegree ? degree : N;
    const Vec s = hn::Sub(hn::Set(d, 1.0), t), zero = hn::Zero(d);
    value[0] = hn::Set(d, 1.0);
    for (int k = 1; k <= n - 2; ++k) raise(k, s, t);
    const Vec second = hn::Set(d, double(n * (n - 1))), first = hn::Set(d, double(n));
    if (n == 1) {
      bend[0] = bend[1] = zero;
    } else {
      Vec before = zero, before_that = zero;
      for (int i = 0; i <= n; ++i) {
        const Vec here = i <= n - 2 ? value[i] : zero;
        bend[i] = hn::Mul(second, hn::Add(hn::Sub(before_that, hn::Add(before, before)), here));
        before_that = before, before = here;
      }
      raise(n - 1, s, t);
    }
    Vec before = zero;
    for (int i = 0; i <= n; ++i) {
      const Vec here = i <= n - 1 ? value[i] : zero;
      slope[i] = hn::Mul(first, hn::Sub(before, here));
      before = here;
    }
    raise(n, s, t);
  }

  // Degree k from degree k - 1 in `value`.
  HWY_INLINE void raise(int k, Vec s, Vec t) {
    value[k] = hn::Mul(t, value[k - 1]);
    for (int i = k - 1; i > 0; --i) value[i] = hn::MulAdd(s, value[i], hn::Mul(t, value[i - 1]));
    value[0] = hn::Mul(s, value[0]);
  }
};

// Homogeneous point and derivatives.
struct HomogeneousJet {
  Vec p[4], pa[4], pb[4], paa[4], pab[4], pbb[4];
};

template <int N, int M>
HWY_INLINE HomogeneousJet homogeneous_jet(Lanes d, const Net& net, Vec a, Vec b) {
  const int n = N == kAnyDegree ? net.n : N, m = M == kAnyDegree ? net.m : M;
  SecondBasis<N> in_a;
  SecondBasis<M> in_b;
  in_a.evaluate(d, n, a);
  in_b.evaluate(d, m, b);
  HomogeneousJet jet;
  for (int c = 0; c < 4; ++c) {
    jet.p[c] = jet.pa[c] = jet.pb[c] = jet.paa[c] = jet.pab[c] = jet.pbb[c] = hn::Zero(d);
  }
  const double* point = net.points;
  for (int i = 0; i <= n; ++i) {
    Vec row[4], slope[4], bend[4];
    for (int c = 0; c < 4; ++c) row[c] = slope[c] = bend[c] = hn::Zero(d);
    for (int j = 0; j <= m; ++j, point += 4) {
      for (int c = 0; c < 4; ++c) {
        const Vec coordinate = hn::Set(d, point[c]);
        row[c] = hn::MulAdd(in_b.value[j], coordinate, row[c]);
        slope[c] = hn::MulAdd(in_b.slope[j], coordinate, slope[c]);
        bend[c] = hn::MulAdd(in_b.bend[j], coordinate, bend[c]);
      }
    }
    for (int c = 0; c < 4; ++c) {
      jet.p[c] = hn::MulAdd(in_a.value[i], row[c], jet.p[c]);
      jet.pa[c] = hn::MulAdd(in_a.slope[i], row[c], jet.pa[c]);
      jet.pb[c] = hn::MulAdd(in_a.value[i], slope[c], jet.pb[c]);
      jet.paa[c] = hn::MulAdd(in_a.bend[i], row[c], jet.paa[c]);
      jet.pab[c] = hn::MulAdd(in_a.slope[i], slope[c], jet.pab[c]);
      jet.pbb[c] = hn::MulAdd(in_a.value[i], bend[c], jet.pbb[c]);
    }
  }
  return jet;
}

// Position and derivatives of the surface in space.
struct Derivatives {
  Vec3 p, a, b, aa, ab, bb;
};

// The quotient rule: with A = w S, A_a = w S_a + w_a S, and so on.
HWY_INLINE Derivatives derivatives(Lanes d, const HomogeneousJet& jet) {
  const Vec r = hn::Div(hn::Set(d, 1.0), jet.p[3]), wa = jet.pa[3], wb = jet.pb[3];
  Vec p[3], a[3], b[3], aa[3], ab[3], bb[3];
  for (int c = 0; c < 3; ++c) {
    p[c] = hn::Div(jet.p[c], jet.p[3]);
    a[c] = hn::Mul(r, hn::NegMulAdd(wa, p[c], jet.pa[c]));
    b[c] = hn::Mul(r, hn::NegMulAdd(wb, p[c], jet.pb[c]));
    aa[c] = hn::Mul(r, hn::NegMulAdd(hn::Add(wa, wa), a[c], hn::NegMulAdd(jet.paa[3], p[c], jet.paa[c])));
    bb[c] = hn::Mul(r, hn::NegMulAdd(hn::Add(wb, wb), b[c], hn::NegMulAdd(jet.pbb[3], p[c], jet.pbb[c])));
    ab[c] = hn::NegMulAdd(wb, a[c], hn::NegMulAdd(wa, b[c], hn::NegMulAdd(jet.pab[3], p[c], jet.pab[c])));
    ab[c] = hn::Mul(r, ab[c]);
  }
  return {{p[0], p[1], p[2]},    {a[0], a[1], a[2]},    {b[0], b[1], b[2]},
          {aa[0], aa[1], aa[2]}, {ab[0], ab[1], ab[2]}, {bb[0], bb[1], bb[2]}};
}

// World vectors from a definition's.
struct Placement {
  Lanes d;
  const double* m;  // (4, 4)

  HWY_INLINE Vec row(int r, const Vec3& v) const {
    return hn::MulAdd(hn::Set(d, m[4 * r]), v.x,
                      hn::MulAdd(hn::Set(d, m[4 * r + 1]), v.y, hn::Mul(hn::Set(d, m[4 * r + 2]), v.z)));
  }
  HWY_INLINE Vec3 vector(const Vec3& v) const { return {row(0, v), row(1, v), row(2, v)}; }
  HWY_INLINE Vec3 point(const Vec3& p) const {
    const Vec3 v = vector(p);
    return {hn::Add(v.x, hn::Set(d, m[3])), hn::Add(v.y, hn::Set(d, m[7])), hn::Add(v.z, hn::Set(d, m[11]))};
  }
};

struct Curvature {
  Vec high, low;
  Vec3 along_high, along_low;
};

// Eigenvalues and eigenvectors of the shape operator ((ee, ef), (ef, ff)) in the orthonormal frame e, f.
HWY_INLINE Curvature principal(Lanes d, Vec ee, Vec ef, Vec ff, const Vec3& e, const Vec3& f) {
  const Vec half = hn::Set(d, 0.5), one = hn::Set(d, 1.0), zero = hn::Zero(d);
  const Vec mean = hn::Mul(half, hn::Add(ee, ff)), difference = hn::Mul(half, hn::Sub(ee, ff));
  const Vec radius = hn::Sqrt(hn::MulAdd(difference, difference, hn::Mul(ef, ef)));
  // Of the half angle's sine and cosine the larger one first, without cancellation.
  const Vec larger = hn::Sqrt(hn::MulAdd(half, hn::Div(hn::Abs(difference), radius), half));
  const Vec smaller = hn::Div(hn::Mul(half, hn::Abs(ef)), hn::Mul(radius, larger));
  const Mask steep = hn::Lt(difference, zero), round = hn::Eq(radius, zero);
  const Vec cosine = hn::IfThenElse(round, one, hn::IfThenElse(steep, smaller, larger));
  const Vec sine = hn::IfThenElse(round, zero, hn::CopySign(hn::IfThenElse(steep, larger, smaller), ef));
  return {hn::Add(mean, radius), hn::Sub(mean, radius), blend(cosine, e, sine, f), blend(cosine, f, hn::Neg(sine), e)};
}

// The shape operator in the frame e, f of the tangent plane, e along a, follows from the second fundamental form:
// II(a, a) = |a|^2 h_ee and so on, with b = b_e e + b_f f.
HWY_INLINE Curvature curvature_of(Lanes d, const SurfaceRun& run, const Derivatives& world, const Vec3& normal) {
  const Vec one = hn::Set(d, 1.0);
  const Vec per_a = hn::Div(one, hn::Sqrt(dot(world.a, world.a)));
  const Vec3 e = scaled(per_a, world.a), f = cross(normal, e);
  const Vec be = dot(world.b, e), per_f = hn::Div(one, dot(world.b, f));
  const Vec ee = hn::Mul(dot(world.aa, normal), hn::Mul(per_a, per_a));
  const Vec ef = hn::Mul(hn::NegMulAdd(be, ee, hn::Mul(dot(world.ab, normal), per_a)), per_f);
  // II(b, b) - b_e (b_e h_ee + 2 b_f h_ef), over b_f^2
  const Vec bent = hn::NegMulAdd(hn::Mul(be, be), ee, dot(world.bb, normal));
  const Vec twice = hn::Add(ef, ef);
  const Vec ff = hn::Mul(hn::NegMulAdd(be, twice, hn::Mul(bent, per_f)), per_f);
  Curvature result = principal(d, ee, ef, ff, e, f);

  const Vec rounding = hn::MulAdd(hn::Set(d, run.rounding_a), hn::Mul(per_a, per_a),
                                  hn::Mul(hn::Set(d, run.rounding_b), hn::Mul(per_f, per_f)));
  const Vec largest = hn::Max(hn::Max(hn::Abs(result.high), hn::Abs(result.low)), hn::Set(d, run.flat));
  const Mask known = hn::Le(rounding, hn::Mul(hn::Set(d, run.known), largest));
  const Vec nothing = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
  for (Vec* value : {&result.high, &result.low, &result.along_high.x, &result.along_high.y, &result.along_high.z,
                     &result.along_low.x, &result.along_low.y, &result.along_low.z}) {
    *value = hn::IfThenElse(known, *value, nothing);
  }
  return result;
}

HWY_INLINE void store(Lanes d, const Vec3& v, std::size_t count, double* out) {
  double lanes[3 * kRunPadding];
  hn::StoreInterleaved3(v.x, v.y, v.z, d, lanes);
  std::copy_n(lanes, 3 * count, out);
}

HWY_INLINE void store_curvature(Lanes d, const Curvature& found, std::size_t count, double* curvature,
                                double* direction) {
  double lanes[2 * kRunPadding], first[3 * kRunPadding], second[3 * kRunPadding];
  hn::StoreInterleaved2(found.high, found.low, d, lanes);
  std::copy_n(lanes, 2 * count, curvature);
  hn::StoreInterleaved3(found.along_high.x, found.along_high.y, found.along_high.z, d, first);
  hn::StoreInterleaved3(found.along_low.x, found.along_low.y, found.along_low.z, d, second);
  for (std::size_t k = 0; k < count; ++k) {
    std::copy_n(first + 3 * k, 3, direction + 6 * k);
    std::copy_n(second + 3 * k, 3, direction + 6 * k + 3);
  }
}

template <int N, int M>
void evaluate_degrees(const SurfaceRun& run) {
  const Lanes d;
  const Placement placement{d, run.placement};
  for (std::size_t first = 0; first < run.count; first += hn::Lanes(d)) {
    const std::size_t count = std::min(hn::Lanes(d), run.count - first);
    const Derivatives local =
        derivatives(d, homogeneous_jet<N, M>(d, run.net, hn::LoadU(d, run.a + first), hn::LoadU(d, run.b + first)));
    store(d, placement.point(local.p), count, run.position + 3 * first);

    const Derivatives world{local.p,
                            placement.vector(local.a),
                            placement.vector(local.b),
                            placement.vector(local.aa),
                            placement.vector(local.ab),
                            placement.vector(local.bb)};
    const Vec3 across = cross(world.a, world.b);
    const Vec squared = dot(across, across);
    const Vec most = hn::Mul(dot(world.a, world.a), dot(world.b, world.b));
    const Mask spans = hn::And(hn::Gt(squared, hn::Mul(hn::Set(d, kFlat * kFlat), most)),
                               hn::And(hn::Gt(dot(local.a, local.a), hn::Set(d, run.vanished_a)),
                                       hn::Gt(dot(local.b, local.b), hn::Set(d, run.vanished_b))));
    const Vec3 normal = scaled(hn::Div(hn::Set(d, run.outward), hn::Sqrt(squared)), across);
    store(d, normal, count, run.normal + 3 * first);
    store_curvature(d, curvature_of(d, run, world, normal), count, run.curvature + 2 * first,
                    run.direction + 6 * first);
    double degenerate[kRunPadding];
    hn::StoreU(hn::IfThenElseZero(hn::Not(spans), hn::Set(d, 1.0)), d, degenerate);
    for (std::size_t k = 0; k < count; ++k) run.degenerate[first + k] = degenerate[k] != 0.0;
  }
}

void EvaluateRun(const SurfaceRun& run) {
  switch (run.net.n * 64 + run.net.m) {
    case 1 * 64 + 1:
      return evaluate_degrees<1, 1>(run);
    case 2 * 64 + 1:
      return evaluate_degrees<2, 1>(run);
    case 2 * 64 + 2:
      return evaluate_degrees<2, 2>(run);
    case 3 * 64 + 3:
      return evaluate_degrees<3, 3>(run);
    default:
      return evaluate_degrees<kAnyDegree, kAnyDegree>(run);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(EvaluateRun);

void evaluate_run(const SurfaceRun& run) { HWY_DYNAMIC_DISPATCH(EvaluateRun)(run); }

}  // namespace nofacet
#endif
