// Points of a span with one in each SIMD lane. Included once for every instruction set (Highway).
#if defined(NOFACET_RASTER_SPAN_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_SPAN_LANES_INL_H_
#undef NOFACET_RASTER_SPAN_LANES_INL_H_
#else
#define NOFACET_RASTER_SPAN_LANES_INL_H_
#endif

#include <algorithm>
#include <cmath>

#include "raster/lanes-inl.h"
#include "raster/span.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

// Along a span the parameters are smooth in this: x, or beside a fold the root of the distance from it.
class SpanProgress {
 public:
  explicit SpanProgress(const Span& span)
      : fold0_(span.fold0), fold1_(span.fold1), x0_(span.x0), x1_(span.x1), scale_(1.0 / (span.x1 - span.x0)) {}

  template <class D, class V = hn::Vec<D>>
  HWY_INLINE V at(D d, V x) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), scale = hn::Set(d, scale_);
    const V t = hn::Min(hn::Max(hn::Mul(hn::Sub(x, hn::Set(d, x0_)), scale), zero), one);
    if (fold0_) return hn::Sqrt(t);
    if (fold1_) return hn::Sub(one, hn::Sqrt(hn::Max(hn::Mul(hn::Sub(hn::Set(d, x1_), x), scale), zero)));
    return t;
  }
  double at(double x) const {
    const double t = std::clamp((x - x0_) * scale_, 0.0, 1.0);
    if (fold0_) return std::sqrt(t);
    if (fold1_) return 1.0 - std::sqrt(std::clamp((x1_ - x) * scale_, 0.0, 1.0));
    return t;
  }
  // dx / dprogress.
  double rate(double progress) const {
    const double length = 1.0 / scale_;
    return fold0_ ? 2.0 * length * progress : fold1_ ? 2.0 * length * (1.0 - progress) : length;
  }

 private:
  bool fold0_, fold1_;
  double x0_, x1_, scale_;
};

// Where the parameters of a span, or of one in each lane, may lie.
struct SpanBox {
  Vec a_lo, a_hi, b_lo, b_hi;

  HWY_INLINE SpanBox(Lanes d, Vec lo, Vec hi) : a_lo(lo), a_hi(hi), b_lo(hn::Zero(d)), b_hi(hn::Set(d, 1.0)) {}
  HWY_INLINE void clamp(Vec& a, Vec& b) const {
    a = hn::Min(hn::Max(a, a_lo), a_hi), b = hn::Min(hn::Max(b, b_lo), b_hi);
  }
  HWY_INLINE Mask contains(Vec a, Vec b) const {
    return hn::And(hn::And(hn::Ge(a, a_lo), hn::Le(a, a_hi)), hn::And(hn::Ge(b, b_lo), hn::Le(b, b_hi)));
  }
};

// First guess: the parameters run evenly with the span's progress.
HWY_INLINE void guess_on_span(Lanes d, const Span& span, Vec progress, Vec& a, Vec& b) {
  a = hn::MulAdd(progress, hn::Set(d, span.a1 - span.a0), hn::Set(d, span.a0));
  b = hn::MulAdd(progress, hn::Set(d, span.b1 - span.b0), hn::Set(d, span.b0));
}

// What positions computed from a net are relative to.
struct Origin {
  double x = 0.0, y = 0.0, key = 0.0;
};
HWY_INLINE Origin origin_of(const Net&) { return {}; }
HWY_INLINE Origin origin_of(const CentredNet& net) { return {net.x, net.y, net.key}; }

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif
