// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/span_keys.cpp"
#include <algorithm>

#include "hwy/foreach_target.h"
#include "raster/span_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

// NetKind: Net or CentredNet. `x` and the results have room for whole vectors.
template <class NetKind>
struct SolveKeys {
  const Span& span;
  const NetKind& net;
  const double* x;
  int count;
  SpanKeys& out;
  double* step;

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    const Lanes d;
    const SpanBox box(d, hn::Set(d, std::min(span.a0, span.a1)), hn::Set(d, std::max(span.a0, span.a1)));
    const SpanProgress progress(span);
    for (int k = 0; k < count; k += int(hn::Lanes(d))) {
      const Vec at = hn::LoadU(d, x + k);
      Vec a, b;
      guess_on_span(d, span, progress.at(d, at), a, b);
      LaneScreen s;
      const Vec last = solve_on_span<kN, kM, kRational>(d, net, box, at, hn::Set(d, span.y), 8, kSpanKeyStep, a, b, s);
      hn::StoreU(a, d, out.a + k), hn::StoreU(s.key, d, out.key + k), hn::StoreU(last, d, step + k);
    }
  }
};

void Solve(const Span& span, const double* x, int count, SpanKeys& out, double* step) {
  const Piece& piece = *span.piece;
  if (piece.has_accurate_centred_net()) {
    for_degrees(piece.centred.n, piece.centred.m, piece.rational,
                SolveKeys<CentredNet>{span, piece.centred, x, count, out, step});
  } else {
    SolveKeys<Net>{span, piece.net, x, count, out, step}.template operator()<-1, -1, true>();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(Solve);

void keys_at(const Span& span, const double* x, int count, SpanKeys* out) {
  double padded[SpanKeys::kMost], step[SpanKeys::kMost];
  const bool linear = span.piece->planar || span.piece->kind > CutKind::fold;
  if (!linear) {
    for (int k = 0; k < SpanKeys::kMost; ++k) padded[k] = x[std::min(k, count - 1)];
    HWY_DYNAMIC_DISPATCH(Solve)(span, padded, count, *out, step);
  }
  for (int k = 0; k < count; ++k) {
    if (x[k] <= span.x0) {
      out->a[k] = span.a0, out->key[k] = span.key0;
    } else if (x[k] >= span.x1) {
      out->a[k] = span.a1, out->key[k] = span.key1;
    } else if (linear || !(step[k] < kSpanKeyStep)) {
      out->key[k] = key_at(span, x[k], &out->a[k]);
    }
  }
}

}  // namespace nofacet
#endif
