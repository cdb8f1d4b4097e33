// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/span_keys.cpp"
#include <algorithm>
#include <cmath>

#include "hwy/foreach_target.h"
#include "raster/solve_pixels.h"
#include "raster/span_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMaxNewton = 8;
// Mostly there are four x: wider registers would be half empty.
using KeyLanes = hn::CappedTag<double, 4>;
using KeyVec = hn::Vec<KeyLanes>;

// Newton's method at every x, until no lane's step is above `enough`. `x` and the results have room for whole vectors.
struct SolveKeys {
  const Span& span;
  const double* x;
  int count;
  double enough;
  SpanKeys& out;
  double* step;  // the last ones

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    const KeyLanes d;
    const SpanProgress progress(span);
    const CentredNet& net = span.piece->centred;
    for (int k = 0; k < count; k += int(hn::Lanes(d))) {
      const KeyVec at = hn::LoadU(d, x + k), p = progress.at(d, at);
      solve<kN, kM, kRational>(d, net, k, hn::Sub(at, hn::Set(d, net.x)),
                               hn::MulAdd(p, hn::Set(d, span.a1 - span.a0), hn::Set(d, span.a0 - 0.5)),
                               hn::MulAdd(p, hn::Set(d, span.b1 - span.b0), hn::Set(d, span.b0 - 0.5)));
    }
  }

 private:
  // x is relative to the net's centre, s and t to its middle.
  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve(KeyLanes d, const CentredNet& net, int k, KeyVec x, KeyVec s, KeyVec t) const {
    const KeyVec y = hn::Set(d, span.y - net.y), half = hn::Set(d, 0.5), one = hn::Set(d, 1.0);
    const KeyVec s_lo = hn::Set(d, std::min(span.a0, span.a1) - 0.5),
                 s_hi = hn::Set(d, std::max(span.a0, span.a1) - 0.5);
    for (int iteration = 1;; ++iteration) {
      KeyVec p[4], ps[4], pt[4];
      horner_lanes<kN, kM, true, kRational>(d, net.n, net.m, net.points, s, t, p, ps, pt);
      const auto system = NewtonSystem<KeyVec>::at<kRational>(p, ps, pt, x, y);
      const KeyVec inverse = hn::Div(one, system.determinant);
      const KeyVec ds = system.step_a(inverse), dt = system.step_b(inverse);
      const KeyVec size = hn::Max(hn::Abs(ds), hn::Abs(dt));
      const KeyVec next_s = hn::Min(hn::Max(hn::Add(s, ds), s_lo), s_hi);
      const KeyVec next_t = hn::Min(hn::Max(hn::Add(t, dt), hn::Neg(half)), half);
      if (iteration < kMaxNewton && !hn::AllTrue(d, hn::Le(size, hn::Set(d, enough)))) {
        s = next_s, t = next_t;
        continue;
      }
      // What of the step the box allowed belongs to the position.
      const KeyVec moved_s = hn::Sub(next_s, s), moved_t = hn::Sub(next_t, t);
      const auto moved = [&](int c) HWY_ATTR { return hn::MulAdd(moved_s, ps[c], hn::MulAdd(moved_t, pt[c], p[c])); };
      KeyVec key = moved(kZ);
      if constexpr (kRational) key = hn::Div(key, moved(kW));
      hn::StoreU(hn::Add(next_s, half), d, out.a + k), hn::StoreU(hn::Add(key, hn::Set(d, net.key)), d, out.key + k);
      hn::StoreU(size, d, step + k);
      return;
    }
  }
};

void Solve(const Span& span, const double* x, int count, double enough, SpanKeys& out, double* step) {
  const Piece& piece = *span.piece;
  for_degrees(piece.centred.n, piece.centred.m, piece.rational, SolveKeys{span, x, count, enough, out, step});
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(Solve);

void keys_at(const Span& span, const double* x, int count, SpanKeys* out) {
  const Piece& piece = *span.piece;
  double padded[SpanKeys::kMost], step[SpanKeys::kMost];
  const double enough = std::max(kSpanKeyStep, std::sqrt(kPixelTolerance / piece.bend));
  // Only what lies inside the span is solved: its ends are known, and at a fold Newton's method is slow.
  const auto is_inside = [&](double at) { return at > span.x0 && at < span.x1; };
  const double* inner = std::find_if(x, x + count, is_inside);
  const bool in_lanes = !piece.planar && piece.kind <= CutKind::fold && piece.has_accurate_centred_net();
  if (in_lanes && inner != x + count) {
    for (int k = 0; k < SpanKeys::kMost; ++k) padded[k] = k < count && is_inside(x[k]) ? x[k] : *inner;
    HWY_DYNAMIC_DISPATCH(Solve)(span, padded, count, enough, *out, step);
  }
  for (int k = 0; k < count; ++k) {
    if (x[k] <= span.x0) {
      out->a[k] = span.a0, out->key[k] = span.key0;
    } else if (x[k] >= span.x1) {
      out->a[k] = span.a1, out->key[k] = span.key1;
    } else if (!in_lanes || !(step[k] <= enough)) {
      out->key[k] = key_at(span, x[k], &out->a[k]);
    }
  }
}

}  // namespace nofacet
#endif
