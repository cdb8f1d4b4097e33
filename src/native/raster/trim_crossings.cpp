#include "raster/trim_crossings.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kLastStep = 1e-7;  // of the portion's range of t

CutPoint between(const TrimPoint& p, const TrimPoint& q, double y) {
  const double f = (y - p.y) / (q.y - p.y);
  return {p.a + f * (q.a - p.a), p.b + f * (q.b - p.b), p.x + f * (q.x - p.x), p.key + f * (q.key - p.key)};
}

// The cubic through both points with their slopes, for t as a function of y.
double hermite(const TrimPoint& p, const TrimPoint& q, double y) {
  const double height = q.y - p.y, f = (y - p.y) / height, g = 1.0 - f;
  const double p_slope = height / p.yt, q_slope = height / q.yt;
  return g * g * ((1.0 + 2.0 * f) * p.t + f * p_slope) + f * f * ((1.0 + 2.0 * g) * q.t - g * q_slope);
}

// On from q with its slope, which changes as it did from p to q.
double extrapolate(const TrimPoint& p, const TrimPoint& q, double y) {
  const double rate = 1.0 / q.yt, height = y - q.y;
  return q.t + height * (rate + 0.5 * height * (rate - 1.0 / p.yt) / (q.y - p.y));
}

// Where the portion crosses the plane.
TrimPoint solve(const Piece& piece, const TrimPortion& portion, double y, double guess) {
  constexpr int kMaxIterations = 60, kMaxNewton = 8;
  const bool rising = portion.to.y > portion.from.y;
  double lo = portion.from.t, hi = portion.to.t;
  const double enough = kLastStep * (hi - lo);
  double t = guess > lo && guess < hi ? guess : lo + (hi - lo) * (y - portion.from.y) / (portion.to.y - portion.from.y);
  TrimPoint point;
  for (int iteration = 1;; ++iteration) {
    point = trim_point(piece, *portion.arc, t);
    const double residual = point.y - y;
    const double next = std::clamp(t - residual / point.yt, portion.from.t, portion.to.t), step = next - t;
    if (std::fabs(step) <= enough || iteration == kMaxIterations) {
      point.t = next;
      point.a += step * point.at, point.b += step * point.bt;
      point.x += step * point.xt, point.y += step * point.yt, point.key += step * point.kt;
      return point;
    }
    ((residual < 0) == rising ? lo : hi) = t;
    t = next > lo && next < hi && iteration <= kMaxNewton ? next : 0.5 * (lo + hi);
  }
}

class PortionCrossings {
 public:
  PortionCrossings(const Piece& piece, const TrimPortion& portion)
      : piece_(piece),
        portion_(portion),
        last_(portion.from.y < portion.to.y ? portion.from : portion.to),
        end_(portion.from.y < portion.to.y ? portion.to : portion.from) {}

  // The crossing with a plane above the last one's.
  CutPoint next(double y) {
    if (portion_.straight) return between(portion_.from, portion_.to, y);
    const TrimPoint point =
        solve(piece_, portion_, y, first_ ? hermite(last_, end_, y) : extrapolate(before_, last_, y));
    before_ = last_, last_ = point, first_ = false;
    return {point.a, point.b, point.x, point.key};
  }

 private:
  const Piece& piece_;
  const TrimPortion& portion_;
  TrimPoint before_{}, last_;
  const TrimPoint& end_;
  bool first_ = true;
};

}  // namespace

void find_trim_crossings(const Piece& piece, const double* y, int count, std::vector<TrimCrossing>& out) {
  struct Crossed {
    int portion, first, last;  // planes
    PortionCrossings crossings;
  };
  std::vector<Crossed> crossed;
  crossed.reserve(piece.portion_count);
  for (int k = 0; k < piece.portion_count; ++k) {
    const TrimPortion& portion = piece.portions[k];
    const double lo = std::min(portion.from.y, portion.to.y), hi = std::max(portion.from.y, portion.to.y);
    if (hi <= y[0] || lo > y[count - 1]) continue;
    // Half-open, as (y0 <= y) != (y1 <= y).
    const int first = int(std::lower_bound(y, y + count, lo) - y), last = int(std::lower_bound(y, y + count, hi) - y);
    if (first < last) crossed.push_back({k, first, last, PortionCrossings(piece, portion)});
  }
  out.clear();
  for (int plane = 0; plane < count; ++plane) {
    const std::size_t start = out.size();
    for (Crossed& portion : crossed) {
      if (plane < portion.first || plane >= portion.last) continue;
      out.push_back({plane, portion.portion, portion.crossings.next(y[plane])});
      for (std::size_t k = out.size() - 1; k > start && out[k].point.a < out[k - 1].point.a; --k) {
        std::swap(out[k], out[k - 1]);
      }
    }
  }
}

}  // namespace nofacet
