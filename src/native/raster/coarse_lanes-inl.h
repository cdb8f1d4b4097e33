// Newton's method in single precision, for first steps from poor guesses. Included once for every instruction set
// (Highway).
#if defined(NOFACET_RASTER_COARSE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_COARSE_LANES_INL_H_
#undef NOFACET_RASTER_COARSE_LANES_INL_H_
#else
#define NOFACET_RASTER_COARSE_LANES_INL_H_
#endif

#include <vector>

#include "raster/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

// A centred net, rounded.
struct CoarseNet {
  int n, m;
  const float* points;

  CoarseNet(const CentredNet& net, std::vector<float>& storage) : n(net.n), m(net.m) {
    const double* end = net.points + 4 * std::size_t(n + 1) * (m + 1);
    storage.assign(net.points, end);
    points = storage.data();
  }
};

// Steps towards (x, y), relative to the net's centre, inside a_lo <= a <= a_hi and |b| <= 1/2, where the parameters are
// relative to the net's middle; until every lane's step is below `enough`.
template <int kN, int kM, bool kRational>
HWY_INLINE void solve_coarse(FloatLanes d, const CoarseNet& net, FloatVec a_lo, FloatVec a_hi, FloatVec x, FloatVec y,
                             int steps, float enough, FloatVec& a, FloatVec& b) {
  const FloatVec b_lo = hn::Set(d, -0.5f), b_hi = hn::Set(d, 0.5f);
  for (int step = 0; step < steps; ++step) {
    FloatVec p[4], pa[4], pb[4];
    horner_lanes<kN, kM, false, kRational>(d, net.n, net.m, net.points, a, b, p, pa, pb);
    const auto system = NewtonSystem<FloatVec>::at<kRational>(p, pa, pb, x, y);
    const FloatVec inverse = hn::Div(hn::Set(d, 1.0f), system.determinant);
    const FloatVec da = system.step_a(inverse), db = system.step_b(inverse);
    a = hn::Min(hn::Max(hn::Add(a, da), a_lo), a_hi), b = hn::Min(hn::Max(hn::Add(b, db), b_lo), b_hi);
    if (hn::AllTrue(d, hn::Lt(hn::Max(hn::Abs(da), hn::Abs(db)), hn::Set(d, enough)))) break;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif
