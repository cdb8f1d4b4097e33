#include "raster/visibility.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kFinestInterval = 0.5;      // pixels
constexpr double kCrossingTolerance = 1e-6;  // pixels

// A span's depth at one x.
struct Probe {
  double a, depth;
};

class Line {
 public:
  Line(const Camera& camera, double tie, const std::vector<VisibleSegment>& segments)
      : camera_(camera), tie_(tie), segments_(segments) {}

  // Inserts the span into `segments`, the ones this line looks at.
  void insert(const Span& span, std::vector<VisibleSegment>& segments) {
    const Range old = merge(span);
    if (!shown_) return;
    const std::ptrdiff_t count = old.last - old.first, size = std::ptrdiff_t(merged_.size());
    const auto first = segments.begin() + old.first;
    if (size > count) {
      segments.insert(first, size - count, {});
    } else {
      segments.erase(first, first + (count - size));
    }
    std::copy(merged_.begin(), merged_.end(), segments.begin() + old.first);
  }

  void append_shown(const Span& span, std::vector<VisibleSegment>& out) {
    merge(span);
    for (const VisibleSegment& segment : merged_) {
      if (segment.span == &span) out.push_back(segment);
    }
  }

 private:
  struct Range {
    std::ptrdiff_t first, last;
  };

  // Writes to merged_ what replaces the segments that the span overlaps, and to shown_ whether it is in it.
  Range merge(const Span& span) {
    double cursor = std::max(span.x0, 0.0);
    const double end = std::min(span.x1, double(camera_.width));
    const auto first = std::upper_bound(segments_.begin(), segments_.end(), cursor,
                                        [](double x, const VisibleSegment& s) { return x < s.x1; });
    merged_.clear();
    shown_ = false;
    auto it = first;
    for (; it != segments_.end() && it->x0 < end; ++it) {
      if (cursor < it->x0) {
        push(cursor, it->x0, &span);
        shown_ = true;
        cursor = it->x0;
      }
      push(it->x0, cursor, it->span);
      const double overlap_end = std::min(it->x1, end);
      shown_ |= compare(span, *it->span, cursor, overlap_end);
      push(overlap_end, it->x1, it->span);
      cursor = overlap_end;
    }
    if (cursor < end) {
      push(cursor, end, &span);
      shown_ = true;
    }
    return {first - segments_.begin(), it - segments_.begin()};
  }

  void push(double x0, double x1, const Span* span) {
    if (!(x0 < x1)) return;
    if (!merged_.empty() && merged_.back().span == span && merged_.back().x1 == x0) {
      merged_.back().x1 = x1;
    } else {
      merged_.push_back({x0, x1, span});
    }
  }

  Probe probe(const Span& span, double x) const {
    Probe p;
    p.depth = depth_at(span, x, camera_, &p.a);
    return p;
  }

  static Interval depth_between(const Span& span, const Probe& p, const Probe& q) {
    if (span.piece->linear) return {std::min(p.depth, q.depth), std::max(p.depth, q.depth)};
    const Interval run = span.piece->depth_slope * (q.a - p.a);
    const Interval from_p{p.depth + std::min(0.0, run.lo), p.depth + std::max(0.0, run.hi)};
    const Interval from_q{q.depth - std::max(0.0, run.hi), q.depth - std::min(0.0, run.lo)};
    return intersect(intersect(from_p, from_q), span.piece->depth);
  }

  // Writes who is nearest on [x0, x1]; returns whether the new span is anywhere.
  bool compare(const Span& fresh, const Span& old, double x0, double x1) {
    if (!(x0 < x1)) return false;
    const double farthest = std::max(old.depth0, old.depth1);
    if (old.piece->linear ? fresh.nearest > farthest + tie_ : fresh.nearest > old.piece->depth.hi + tie_) {
      push(x0, x1, &old);
      return false;
    }
    return compare(fresh, old, x0, x1, probe(fresh, x0), probe(fresh, x1), probe(old, x0), probe(old, x1));
  }

  bool compare(const Span& fresh, const Span& old, double x0, double x1, Probe f0, Probe f1, Probe o0, Probe o1) {
    const Interval f = depth_between(fresh, f0, f1), o = depth_between(old, o0, o1);
    if (f.lo > o.hi + tie_) {
      push(x0, x1, &old);
      return false;
    }
    if (f.hi < o.lo - tie_) {
      push(x0, x1, &fresh);
      return true;
    }
    const bool both_linear = fresh.piece->linear && old.piece->linear;
    if (x1 - x0 > kFinestInterval && !both_linear) {
      const double middle = 0.5 * (x0 + x1);
      const Probe fm = probe(fresh, middle), om = probe(old, middle);
      const bool left = compare(fresh, old, x0, middle, f0, fm, o0, om);
      return compare(fresh, old, middle, x1, fm, f1, om, o1) || left;
    }
    const double d0 = f0.depth - o0.depth, d1 = f1.depth - o1.depth;
    const bool tie0 = std::fabs(d0) <= tie_, tie1 = std::fabs(d1) <= tie_;
    if (tie0 || tie1 || (d0 < 0) == (d1 < 0)) {
      // No crossing inside; surfaces that touch at one end are told apart at the other.
      const bool nearer = tie0 && tie1 ? fresh.piece->face < old.piece->face : (tie0 ? d1 : d0) < 0;
      push(x0, x1, nearer ? &fresh : &old);
      return nearer;
    }
    const double crossing = solve_crossing(fresh, old, x0, x1, d0, d1);
    push(x0, crossing, d0 < 0 ? &fresh : &old);
    push(crossing, x1, d1 < 0 ? &fresh : &old);
    return true;
  }

  // Where the depth difference, of opposite signs at x0 and x1, vanishes.
  double solve_crossing(const Span& fresh, const Span& old, double x0, double x1, double d0, double d1) const {
    for (int iteration = 0; iteration < 60 && x1 - x0 > kCrossingTolerance; ++iteration) {
      double x = iteration % 3 == 2 ? 0.5 * (x0 + x1) : x0 + (x1 - x0) * d0 / (d0 - d1);
      if (!(x > x0 && x < x1)) x = 0.5 * (x0 + x1);
      const double d = probe(fresh, x).depth - probe(old, x).depth;
      if (d == 0.0) return x;
      if ((d < 0) == (d0 < 0)) {
        if (x - x0 < kCrossingTolerance) return x;
        x0 = x, d0 = d;
      } else {
        if (x1 - x < kCrossingTolerance) return x;
        x1 = x, d1 = d;
      }
    }
    return 0.5 * (x0 + x1);
  }

  const Camera& camera_;
  double tie_;
  const std::vector<VisibleSegment>& segments_;
  std::vector<VisibleSegment> merged_;
  bool shown_ = false;
};

}  // namespace

void resolve_visibility(std::vector<Span>& spans, const Camera& camera, double tie, std::vector<VisibleSegment>& out) {
  out.clear();
  // Nearest first, so that most hidden spans meet at once what hides them. The sort is stable: pieces come in a fixed
  // order, so equal depths are resolved the same way whatever thread draws the row.
  std::stable_sort(spans.begin(), spans.end(), [](const Span& p, const Span& q) { return p.nearest < q.nearest; });
  Line line(camera, tie, out);
  for (const Span& span : spans) line.insert(span, out);
}

void visible_parts(const Span& span, const std::vector<VisibleSegment>& segments, const Camera& camera, double tie,
                   std::vector<VisibleSegment>& out) {
  Line(camera, tie, segments).append_shown(span, out);
}

}  // namespace nofacet
