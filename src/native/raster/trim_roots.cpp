// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/trim_roots.cpp"
#include "raster/trim_roots.h"

#include "hwy/foreach_target.h"

// After that, for every instruction set.
#include "hwy/contrib/math/math-inl.h"
#include "raster/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMaxNewton = 12;

struct LaneCurve {
  Vec u, v, du, dv;
};

template <int kDegree>
HWY_INLINE LaneCurve evaluate_curve(Lanes d, const double* points, int degree, Vec t) {
  LaneBasis<kDegree> basis;
  basis.set(d, degree, t);
  Vec p[3], slope[3];
  for (int c = 0; c < 3; ++c) p[c] = slope[c] = hn::Zero(d);
  for (int i = 0; i <= (kDegree >= 0 ? kDegree : degree); ++i, points += 3) {
    for (int c = 0; c < 3; ++c) {
      const Vec q = hn::Set(d, points[c]);
      p[c] = hn::MulAdd(basis.value_at(d, i), q, p[c]);
      slope[c] = hn::MulAdd(basis.slope_at(d, i), q, slope[c]);
    }
  }
  const Vec r = hn::Div(hn::Set(d, 1.0), p[2]), u = hn::Mul(p[0], r), v = hn::Mul(p[1], r);
  return {u, v, hn::Mul(hn::NegMulAdd(u, slope[2], slope[0]), r), hn::Mul(hn::NegMulAdd(v, slope[2], slope[1]), r)};
}

HWY_INLINE LaneCurve evaluate_curve(Lanes d, const TrimArc& arc, Vec t) {
  switch (arc.degree) {
    case 1:
      return evaluate_curve<1>(d, arc.points, 1, t);
    case 2:
      return evaluate_curve<2>(d, arc.points, 2, t);
    case 3:
      return evaluate_curve<3>(d, arc.points, 3, t);
    default:
      return evaluate_curve<-1>(d, arc.points, arc.degree, t);
  }
}

// The parameter of a piece that spans [s0, s1] of its patch, and its derivative by u (ParameterMap::local).
HWY_INLINE void to_piece(Lanes d, const ParameterMap& map, double s0, double s1, Vec u, Vec& a, Vec& slope) {
  const double scale = 1.0 / (s1 - s0);
  if (!map.angular) {
    const double rate = 1.0 / (map.u1 - map.u0);
    slope = hn::Set(d, rate * scale);
    a = hn::Mul(hn::MulSub(hn::Sub(u, hn::Set(d, map.u0)), hn::Set(d, rate), hn::Set(d, s0)), hn::Set(d, scale));
    return;
  }
  const Vec half = hn::Mul(hn::Set(d, 0.5), hn::Sub(u, hn::Set(d, 0.5 * (map.u0 + map.u1))));
  const Vec t = hn::Div(hn::Sin(d, half), hn::Cos(d, half));
  a = hn::Mul(hn::MulAdd(t, hn::Set(d, 0.5 / map.tangent), hn::Set(d, 0.5 - s0)), hn::Set(d, scale));
  slope = hn::Mul(hn::MulAdd(t, t, hn::Set(d, 1.0)), hn::Set(d, 0.25 / map.tangent * scale));
}

struct SolveTrims {
  const Piece& piece;
  const TrimPortion& portion;
  std::size_t count;
  PlaneRoots& roots;

  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void operator()() const {
    const Lanes d;
    const TrimPoint &from = portion.from, &to = portion.to;
    const double range = to.t - from.t, height = to.y - from.y;
    // The guess is the cubic in y with the curve's own slopes at both ends, if it is monotone.
    const auto rate = [&](double by_t) {
      const double rate = height / (by_t * range);
      return rate >= 0.0 && rate <= 3.0 ? rate : 1.0;
    };
    const double r0 = rate(from.yt), r1 = rate(to.yt);
    const Vec first = hn::Set(d, from.t), last = hn::Set(d, to.t);
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
      const Vec y = hn::LoadU(d, roots.y.data() + k);
      const Vec f = hn::Mul(hn::Sub(y, hn::Set(d, from.y)), hn::Set(d, 1.0 / height));
      const Vec c1 =
          hn::MulAdd(hn::MulAdd(f, hn::Set(d, r0 + r1 - 2.0), hn::Set(d, 3.0 - 2.0 * r0 - r1)), f, hn::Set(d, r0));
      solve<kN, kM, kRational>(d, k, y, hn::MulAdd(hn::Mul(f, c1), hn::Set(d, range), first), first, last);
    }
  }

 private:
  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve(Lanes d, std::size_t k, Vec y, Vec t, Vec first, Vec last) const {
    const Vec scale = hn::Set(d, 1.0 / (portion.to.t - portion.from.t)), one = hn::Set(d, 1.0);
    for (int iteration = 1;; ++iteration) {
      const LaneCurve curve = evaluate_curve(d, *portion.arc, t);
      Vec a, b, at, bt;
      to_piece(d, piece.patch->u, piece.s0, piece.s1, curve.u, a, at);
      to_piece(d, piece.patch->v, piece.t0, piece.t1, curve.v, b, bt);
      at = hn::Mul(at, curve.du), bt = hn::Mul(bt, curve.dv);
      if (piece.transposed) std::swap(a, b), std::swap(at, bt);
      LaneJet jet;
      evaluate_lanes<kN, kM, kRational>(d, piece.net, a, b, jet);
      const auto by_t = [&](int c) HWY_ATTR { return hn::MulAdd(jet.pa[c], at, hn::Mul(jet.pb[c], bt)); };
      Vec w = one, wt = hn::Zero(d);
      if constexpr (kRational) w = jet.p[kW], wt = by_t(kW);
      const Vec step = hn::Div(hn::NegMulAdd(y, w, jet.p[kY]), hn::MulSub(y, wt, by_t(kY)));
      const Vec next = hn::Min(hn::Max(hn::Add(t, step), first), last);
      const Vec size = hn::Mul(hn::Abs(step), scale);
      if (iteration < kMaxNewton && !hn::AllTrue(d, hn::Lt(size, hn::Set(d, kTrimStep)))) {
        t = next;
        continue;
      }
      const Vec moved = hn::Sub(next, t);
      const Vec inverse = kRational ? hn::Div(one, hn::MulAdd(moved, wt, w)) : one;
      hn::StoreU(hn::MulAdd(moved, at, a), d, roots.a.data() + k);
      hn::StoreU(hn::MulAdd(moved, bt, b), d, roots.b.data() + k);
      hn::StoreU(hn::Mul(hn::MulAdd(moved, by_t(kX), jet.p[kX]), inverse), d, roots.x.data() + k);
      hn::StoreU(hn::Mul(hn::MulAdd(moved, by_t(kZ), jet.p[kZ]), inverse), d, roots.key.data() + k);
      hn::StoreU(size, d, roots.step.data() + k);
      return;
    }
  }
};

void TrimRoots(const Piece& piece, const TrimPortion& portion, std::size_t count, PlaneRoots& roots) {
  for_degrees(piece.net.n, piece.net.m, piece.rational, SolveTrims{piece, portion, count, roots});
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(TrimRoots);

void trim_roots(const Piece& piece, const TrimPortion& portion, std::size_t count, PlaneRoots& roots) {
  HWY_DYNAMIC_DISPATCH(TrimRoots)(piece, portion, count, roots);
}

}  // namespace nofacet
#endif
