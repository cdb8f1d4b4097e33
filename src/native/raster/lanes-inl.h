// Bernstein forms evaluated with one point in each SIMD lane. Included once for every instruction set (Highway).
#if defined(NOFACET_RASTER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_LANES_INL_H_
#undef NOFACET_RASTER_LANES_INL_H_
#else
#define NOFACET_RASTER_LANES_INL_H_
#endif

#include "bezier/centred_net.h"
#include "bezier/net.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<double, 8>;
using Vec = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;
// Twice as many as doubles in a register.
using FloatLanes = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<FloatLanes>;

// 1 / sqrt(v) in single precision, to a few units in the last place: an approximation and a step of Newton's method.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V inverse_root(D d, V v) {
  const V r = hn::ApproximateReciprocalSqrt(v), half = hn::Mul(hn::Set(d, 0.5f), v);
  return hn::Mul(r, hn::NegMulAdd(hn::Mul(half, r), r, hn::Set(d, 1.5f)));
}

// Bernstein basis of a degree known at compile time, or read from the net (kDegree = -1), and its derivative.
template <int kDegree>
struct LaneBasis {
  Vec value[kDegree + 1], slope[kDegree + 1];

  HWY_INLINE void set(Lanes d, int, Vec t) {
    const Vec one = hn::Set(d, 1.0), s = hn::Sub(one, t);
    if constexpr (kDegree == 1) {
      value[0] = s, value[1] = t;
      slope[0] = hn::Neg(one), slope[1] = one;
    } else if constexpr (kDegree == 2) {
      const Vec two = hn::Set(d, 2.0);
      value[0] = hn::Mul(s, s), value[1] = hn::Mul(two, hn::Mul(s, t)), value[2] = hn::Mul(t, t);
      slope[0] = hn::Mul(hn::Set(d, -2.0), s), slope[1] = hn::Mul(two, hn::Sub(s, t)), slope[2] = hn::Mul(two, t);
    } else {
      const Vec three = hn::Set(d, 3.0);
      const Vec ss = hn::Mul(s, s), tt = hn::Mul(t, t), s3 = hn::Mul(three, s), t3 = hn::Mul(three, t);
      const Vec st2 = hn::Mul(hn::Set(d, 2.0), hn::Mul(s, t));
      value[0] = hn::Mul(ss, s), value[1] = hn::Mul(ss, t3), value[2] = hn::Mul(tt, s3), value[3] = hn::Mul(tt, t);
      slope[0] = hn::Mul(hn::Set(d, -3.0), ss), slope[1] = hn::Mul(three, hn::Sub(ss, st2));
      slope[2] = hn::Mul(three, hn::Sub(st2, tt)), slope[3] = hn::Mul(three, tt);
    }
  }
  HWY_INLINE Vec value_at(Lanes, int i) const { return value[i]; }
  HWY_INLINE Vec slope_at(Lanes, int i) const { return slope[i]; }
};

template <>
struct LaneBasis<-1> {
  HWY_ALIGN double value[(kMaxDegree + 1) * 8];
  HWY_ALIGN double slope[(kMaxDegree + 1) * 8];

  HWY_INLINE void set(Lanes d, int n, Vec t) {
    const std::size_t width = hn::Lanes(d);
    const Vec s = hn::Sub(hn::Set(d, 1.0), t);
    double* v = value;
    // Degree n - 1 first: the derivative is made of it.
    hn::Store(hn::Set(d, 1.0), d, v);
    for (int k = 1; k < n; ++k) {
      Vec carry = hn::Zero(d);
      for (int i = 0; i < k; ++i) {
        const Vec b = hn::Load(d, v + i * width);
        hn::Store(hn::MulAdd(s, b, carry), d, v + i * width);
        carry = hn::Mul(t, b);
      }
      hn::Store(carry, d, v + k * width);
    }
    const Vec degree = hn::Set(d, double(n));
    Vec before = hn::Zero(d);
    for (int i = 0; i < n; ++i) {
      const Vec b = hn::Load(d, v + i * width);
      hn::Store(hn::Mul(degree, hn::Sub(before, b)), d, slope + i * width);
      hn::Store(hn::MulAdd(s, b, hn::Mul(t, before)), d, v + i * width);
      before = b;
    }
    hn::Store(hn::Mul(degree, before), d, slope + n * width);
    hn::Store(hn::Mul(t, before), d, v + n * width);
  }
  HWY_INLINE Vec value_at(Lanes d, int i) const { return hn::Load(d, value + i * hn::Lanes(d)); }
  HWY_INLINE Vec slope_at(Lanes d, int i) const { return hn::Load(d, slope + i * hn::Lanes(d)); }
};

// Homogeneous points and first derivatives of one group of lanes. Where the weight is 1 all over the net
// (kRational = false) its entries are neither computed nor read.
struct LaneJet {
  Vec p[4], pa[4], pb[4];
};

template <int kN, int kM, bool kRational>
HWY_INLINE void evaluate_lanes(Lanes d, const Net& net, Vec a, Vec b, LaneJet& jet) {
  const int n = kN >= 0 ? kN : net.n, m = kM >= 0 ? kM : net.m;
  LaneBasis<kN> in_a;
  LaneBasis<kM> in_b;
  in_a.set(d, n, a);
  in_b.set(d, m, b);
  if constexpr (kN >= 0 && kM >= 0) {
    // One component after the other: the bases stay in registers.
    for (const int c : {kX, kY, kZ, kW}) {
      if (c == kW && !kRational) continue;
      const double* point = net.points + c;
      Vec p, pa, pb;
      for (int i = 0; i <= kN; ++i) {
        Vec row = hn::Mul(in_b.value[0], hn::Set(d, point[0])), slope = hn::Mul(in_b.slope[0], hn::Set(d, point[0]));
        for (int j = 1; j <= kM; ++j) {
          const Vec q = hn::Set(d, point[4 * j]);
          row = hn::MulAdd(in_b.value[j], q, row), slope = hn::MulAdd(in_b.slope[j], q, slope);
        }
        point += 4 * (kM + 1);
        if (i == 0) {
          p = hn::Mul(in_a.value[0], row), pa = hn::Mul(in_a.slope[0], row), pb = hn::Mul(in_a.value[0], slope);
        } else {
          p = hn::MulAdd(in_a.value[i], row, p), pa = hn::MulAdd(in_a.slope[i], row, pa);
          pb = hn::MulAdd(in_a.value[i], slope, pb);
        }
      }
      jet.p[c] = p, jet.pa[c] = pa, jet.pb[c] = pb;
    }
  } else {
    for (int c = 0; c < 4; ++c) jet.p[c] = jet.pa[c] = jet.pb[c] = hn::Zero(d);
    const double* point = net.points;
    for (int i = 0; i <= n; ++i) {
      Vec row0 = hn::Zero(d), row1 = row0, row2 = row0, row3 = row0;
      Vec slope0 = row0, slope1 = row0, slope2 = row0, slope3 = row0;
      for (int j = 0; j <= m; ++j, point += 4) {
        const Vec v = in_b.value_at(d, j), s = in_b.slope_at(d, j);
        const Vec x = hn::Set(d, point[kX]), y = hn::Set(d, point[kY]), z = hn::Set(d, point[kZ]);
        row0 = hn::MulAdd(v, x, row0), slope0 = hn::MulAdd(s, x, slope0);
        row1 = hn::MulAdd(v, y, row1), slope1 = hn::MulAdd(s, y, slope1);
        row3 = hn::MulAdd(v, z, row3), slope3 = hn::MulAdd(s, z, slope3);
        if constexpr (kRational) {
          const Vec w = hn::Set(d, point[kW]);
          row2 = hn::MulAdd(v, w, row2), slope2 = hn::MulAdd(s, w, slope2);
        }
      }
      const Vec v = in_a.value_at(d, i), s = in_a.slope_at(d, i);
      const auto add = [&](int c, Vec row, Vec slope) HWY_ATTR {
        jet.p[c] = hn::MulAdd(v, row, jet.p[c]);
        jet.pa[c] = hn::MulAdd(s, row, jet.pa[c]);
        jet.pb[c] = hn::MulAdd(v, slope, jet.pb[c]);
      };
      add(kX, row0, slope0);
      add(kY, row1, slope1);
      add(kZ, row3, slope3);
      if constexpr (kRational) add(kW, row2, slope2);
    }
  }
}

// Horner's rule for a form in powers of s and t, of the components x and y and, if wanted, the key and the weight.
// T: the numbers' type. p, pa, pb: value and derivatives, as in a jet.
template <int kN, int kM, bool kKey, bool kRational, class D, class T, class V = hn::Vec<D>>
HWY_INLINE void horner_lanes(D d, int form_n, int form_m, const T* points, V s, V t, V p[4], V pa[4], V pb[4]) {
  const int n = kN >= 0 ? kN : form_n, m = kM >= 0 ? kM : form_m;
  constexpr int kCount = 2 + kKey + kRational;
  constexpr Component kOrder[4] = {kX, kY, kKey ? kZ : kW, kW};
  const T* row = points + 4 * std::size_t(n) * (m + 1);
  if constexpr (kN < 0) {
    for (int c = 0; c < 4; ++c) p[c] = pa[c] = pb[c] = hn::Zero(d);
  }
  for (int i = n; i >= 0; --i, row -= 4 * (m + 1)) {
    V value[4], slope[4];
    for (int k = 0; k < kCount; ++k) {
      slope[k] = hn::Set(d, row[4 * m + kOrder[k]]);
      value[k] = hn::MulAdd(slope[k], t, hn::Set(d, row[4 * (m - 1) + kOrder[k]]));
    }
    for (int j = m - 2; j >= 0; --j) {
      for (int k = 0; k < kCount; ++k) {
        slope[k] = hn::MulAdd(slope[k], t, value[k]);
        value[k] = hn::MulAdd(value[k], t, hn::Set(d, row[4 * j + kOrder[k]]));
      }
    }
    for (int k = 0; k < kCount; ++k) {
      const int c = kOrder[k];
      if (i == n) {
        p[c] = value[k], pb[c] = slope[k], pa[c] = hn::Zero(d);
      } else {
        pa[c] = hn::MulAdd(pa[c], s, p[c]);
        p[c] = hn::MulAdd(p[c], s, value[k]);
        pb[c] = hn::MulAdd(pb[c], s, slope[k]);
      }
    }
  }
}

// The same as for a net, in less than two thirds of the time. Positions are relative to the net's centre.
template <int kN, int kM, bool kRational>
HWY_INLINE void evaluate_lanes(Lanes d, const CentredNet& net, Vec a, Vec b, LaneJet& jet) {
  const Vec half = hn::Set(d, 0.5);
  horner_lanes<kN, kM, true, kRational>(d, net.n, net.m, net.points, hn::Sub(a, half), hn::Sub(b, half), jet.p, jet.pa,
                                        jet.pb);
}

// The same without derivatives.
template <int kN, int kM, bool kRational>
HWY_INLINE void evaluate_positions(Lanes d, const CentredNet& net, Vec a, Vec b, Vec p[4]) {
  const int n = kN >= 0 ? kN : net.n, m = kM >= 0 ? kM : net.m;
  const Vec half = hn::Set(d, 0.5), s = hn::Sub(a, half), t = hn::Sub(b, half);
  const double* row = net.points + 4 * std::size_t(n) * (m + 1);
  for (int c = 0; c < 4; ++c) p[c] = hn::Zero(d);
  for (int i = n; i >= 0; --i, row -= 4 * (m + 1)) {
    for (const int c : {kX, kY, kZ, kW}) {
      if (c == kW && !kRational) continue;
      Vec value = hn::Set(d, row[4 * m + c]);
      for (int j = m - 1; j >= 0; --j) value = hn::MulAdd(value, t, hn::Set(d, row[4 * j + c]));
      p[c] = hn::MulAdd(p[c], s, value);
    }
  }
}

template <int kN, int kM, bool kRational>
HWY_INLINE void evaluate_positions(Lanes d, const Net& net, Vec a, Vec b, Vec p[4]) {
  LaneJet jet;
  evaluate_lanes<kN, kM, kRational>(d, net, a, b, jet);
  for (int c = 0; c < 4; ++c) p[c] = jet.p[c];
}

// What a step of Newton's method towards (x, y) solves in each lane: F = P - (x, y) W vanishes at the solution. There
// F_a = W x_a and so on, and the determinant is W^2 times the Jacobian.
template <class V>
struct NewtonSystem {
  V fx, fy, fxa, fxb, fya, fyb, determinant;

  template <bool kRational>
  static HWY_INLINE NewtonSystem at(const V p[4], const V pa[4], const V pb[4], V x, V y) {
    NewtonSystem system;
    system.fxa = pa[kX], system.fxb = pb[kX], system.fya = pa[kY], system.fyb = pb[kY];
    if constexpr (kRational) {
      system.fx = hn::NegMulAdd(x, p[kW], p[kX]), system.fy = hn::NegMulAdd(y, p[kW], p[kY]);
      system.fxa = hn::NegMulAdd(x, pa[kW], system.fxa), system.fya = hn::NegMulAdd(y, pa[kW], system.fya);
      system.fxb = hn::NegMulAdd(x, pb[kW], system.fxb), system.fyb = hn::NegMulAdd(y, pb[kW], system.fyb);
    } else {
      system.fx = hn::Sub(p[kX], x), system.fy = hn::Sub(p[kY], y);
    }
    system.determinant = hn::MulSub(system.fxa, system.fyb, hn::Mul(system.fxb, system.fya));
    return system;
  }
  // The step, with the inverse of the determinant.
  HWY_INLINE V step_a(V inverse) const { return hn::Mul(hn::MulSub(fy, fxb, hn::Mul(fx, fyb)), inverse); }
  HWY_INLINE V step_b(V inverse) const { return hn::Mul(hn::MulSub(fx, fya, hn::Mul(fy, fxa)), inverse); }
};

// Calls body.template operator()<kN, kM, kRational>() with the net's degrees where kernels are made for them.
template <class Body>
HWY_INLINE void for_degrees(int n, int m, bool rational, const Body& body) {
  const auto with = [&](auto kn, auto km) HWY_ATTR {
    constexpr int kN = decltype(kn)::value, kM = decltype(km)::value;
    if (rational) {
      body.template operator()<kN, kM, true>();
    } else {
      body.template operator()<kN, kM, false>();
    }
  };
  using std::integral_constant;
  const auto second = [&](auto kn) HWY_ATTR {
    switch (m) {
      case 1:
        return with(kn, integral_constant<int, 1>());
      case 2:
        return with(kn, integral_constant<int, 2>());
      case 3:
        return with(kn, integral_constant<int, 3>());
      default:
        return with(integral_constant<int, -1>(), integral_constant<int, -1>());
    }
  };
  switch (n) {
    case 1:
      return second(integral_constant<int, 1>());
    case 2:
      return second(integral_constant<int, 2>());
    case 3:
      return second(integral_constant<int, 3>());
    default:
      return with(integral_constant<int, -1>(), integral_constant<int, -1>());
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif
