#include "raster/trim_crossings.h"

#include <algorithm>
#include <cmath>

#include "raster/trim_roots.h"

namespace nofacet {
namespace {

CutPoint between(const TrimPoint& p, const TrimPoint& q, double y) {
  const double f = (y - p.y) / (q.y - p.y);
  return {p.a + f * (q.a - p.a), p.b + f * (q.b - p.b), p.x + f * (q.x - p.x), p.key + f * (q.key - p.key)};
}

// Where the portion crosses the plane: Newton's method, bracketed.
CutPoint bracketed_crossing(const Piece& piece, const TrimPortion& portion, double y) {
  constexpr int kMaxIterations = 60, kMaxNewton = 8;
  const bool rising = portion.to.y > portion.from.y;
  double lo = portion.from.t, hi = portion.to.t;
  const double enough = kTrimStep * (hi - lo);
  double t = lo + (hi - lo) * (y - portion.from.y) / (portion.to.y - portion.from.y);
  for (int iteration = 1;; ++iteration) {
    const TrimPoint point = trim_point(piece, *portion.arc, t);
    const double residual = point.y - y;
    const double next = std::clamp(t - residual / point.yt, portion.from.t, portion.to.t), step = next - t;
    if (std::fabs(step) <= enough || iteration == kMaxIterations) {
      return {point.a + step * point.at, point.b + step * point.bt, point.x + step * point.xt,
              point.key + step * point.kt};
    }
    ((residual < 0) == rising ? lo : hi) = t;
    t = next > lo && next < hi && iteration <= kMaxNewton ? next : 0.5 * (lo + hi);
  }
}

}  // namespace

void TrimCrosser::Crossed::solve(const Piece& piece, const double* y) {
  const TrimPortion& of = piece.portions[portion];
  if (of.straight) return;
  const std::size_t count = last - first;
  roots.resize(count);
  std::copy(y + first, y + last, roots.y.begin());
  roots.pad(count);
  trim_roots(piece, of, count, roots);
  for (std::size_t k = 0; k < count; ++k) {
    if (roots.step[k] < kTrimStep) continue;
    const CutPoint point = bracketed_crossing(piece, of, roots.y[k]);
    roots.a[k] = point.a, roots.b[k] = point.b, roots.x[k] = point.x, roots.key[k] = point.key;
  }
}

CutPoint TrimCrosser::Crossed::point(const Piece& piece, double y, int plane) const {
  const TrimPortion& of = piece.portions[portion];
  if (of.straight) return between(of.from, of.to, y);
  const int k = plane - first;
  return {roots.a[k], roots.b[k], roots.x[k], roots.key[k]};
}

const std::vector<TrimCrossing>& TrimCrosser::cross(const Piece& piece, const double* y, int count) {
  crossed_count_ = 0;
  int plane = count, end = 0;
  for (int k = 0; k < piece.portion_count; ++k) {
    const TrimPortion& portion = piece.portions[k];
    const double lo = std::min(portion.from.y, portion.to.y), hi = std::max(portion.from.y, portion.to.y);
    if (hi <= y[0] || lo > y[count - 1]) continue;
    // Half-open, as (y0 <= y) != (y1 <= y).
    const int first = int(std::lower_bound(y, y + count, lo) - y), last = int(std::lower_bound(y, y + count, hi) - y);
    if (first == last) continue;
    if (crossed_count_ == crossed_.size()) crossed_.emplace_back();
    Crossed& crossed = crossed_[crossed_count_++];
    crossed.portion = k, crossed.first = first, crossed.last = last;
    crossed.solve(piece, y);
    plane = std::min(plane, first), end = std::max(end, last);
  }
  crossings_.clear();
  for (; plane < end; ++plane) {
    const std::size_t start = crossings_.size();
    for (std::size_t i = 0; i < crossed_count_; ++i) {
      const Crossed& crossed = crossed_[i];
      if (plane < crossed.first || plane >= crossed.last) continue;
      crossings_.push_back({plane, crossed.portion, crossed.point(piece, y[plane], plane)});
      for (std::size_t k = crossings_.size() - 1; k > start && crossings_[k].point.a < crossings_[k - 1].point.a; --k) {
        std::swap(crossings_[k], crossings_[k - 1]);
      }
    }
  }
  return crossings_;
}

}  // namespace nofacet
