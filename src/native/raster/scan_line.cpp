#include "raster/scan_line.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kFinestInterval = 0.5;      // pixels
constexpr double kCrossingTolerance = 1e-6;  // pixels

auto first_after(const std::vector<VisibleSegment>& segments, double x) {
  return std::upper_bound(segments.begin(), segments.end(), x,
                          [](double value, const VisibleSegment& s) { return value < s.x1; });
}

}  // namespace

bool ScanLine::hides(double x0, double x1, double nearest) const {
  double cursor = x0;
  for (auto it = first_after(segments, x0); it != segments.end() && it->x0 <= cursor; ++it) {
    if (it->span->farthest >= nearest) return false;
    if (it->x1 >= x1) return true;
    cursor = it->x1;
  }
  return false;
}

void ScanLine::covered(double width, std::vector<Interval>& out) const {
  out.clear();
  for (const VisibleSegment& segment : segments) out.push_back({segment.x0, segment.x1});
  for (const Span* span : transparent) out.push_back({std::max(span->x0, 0.0), std::min(span->x1, width)});
  merge_stretches(out);
}

void merge_stretches(std::vector<Interval>& stretches) {
  std::sort(stretches.begin(), stretches.end(), [](const Interval& p, const Interval& q) { return p.lo < q.lo; });
  std::size_t kept = 0;
  for (const Interval& next : stretches) {
    // Neighbouring faces meet but for rounding.
    if (kept > 0 && next.lo <= stretches[kept - 1].hi + kSliverPixels) {
      stretches[kept - 1].hi = std::max(stretches[kept - 1].hi, next.hi);
    } else {
      stretches[kept++] = next;
    }
  }
  stretches.resize(kept);
}

bool Visibility::hidden(const Span& span, const std::vector<VisibleSegment>& segments) const {
  const double end = std::min(span.x1, double(camera_.width));
  double cursor = std::max(span.x0, 0.0);
  for (auto it = first_after(segments, cursor); it != segments.end() && it->x0 <= cursor; ++it) {
    const Span& old = *it->span;
    if (decide({span.nearest, span.farthest}, {old.nearest, old.farthest}, tie(old.nearest), span, old) != &old) {
      return false;
    }
    if (it->x1 >= end) return true;
    cursor = it->x1;
  }
  return false;
}

void Visibility::insert(const Span& span, std::vector<VisibleSegment>& segments) {
  const double x0 = std::max(span.x0, 0.0), x1 = std::min(span.x1, double(camera_.width));
  if (const auto next = first_after(segments, x0); next == segments.end() || next->x0 >= x1) {
    if (x0 < x1) segments.insert(next, {x0, x1, &span});
    return;
  }
  const Range old = merge(span, segments);
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

void Visibility::append_visible(const Span& span, const std::vector<VisibleSegment>& segments,
                                std::vector<VisibleSegment>& out) {
  merge(span, segments);
  for (const VisibleSegment& segment : merged_) {
    if (segment.span == &span) out.push_back(segment);
  }
}

// Writes to merged_ what replaces the segments that the span overlaps, and to shown_ whether it is in it.
Visibility::Range Visibility::merge(const Span& span, const std::vector<VisibleSegment>& segments) {
  double cursor = std::max(span.x0, 0.0);
  const double end = std::min(span.x1, double(camera_.width));
  const auto first = first_after(segments, cursor);
  merged_.clear();
  shown_ = false;
  auto it = first;
  for (; it != segments.end() && it->x0 < end; ++it) {
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
  return {first - segments.begin(), it - segments.begin()};
}

void Visibility::push(double x0, double x1, const Span* span) {
  if (!(x0 < x1)) return;
  if (!merged_.empty() && merged_.back().span == span && merged_.back().x1 == x0) {
    merged_.back().x1 = x1;
  } else {
    merged_.push_back({x0, x1, span});
  }
}

bool Visibility::show(const Span* winner, const Span& fresh, double x0, double x1) {
  push(x0, x1, winner);
  return winner == &fresh;
}

// Who is nearest if the keys lie in these ranges; null if they do not tell. Ranges that only touch do: surfaces may
// meet at an edge. Where all keys are the same, the face with the lower index is.
const Span* Visibility::decide(Interval fresh_key, Interval old_key, double tie, const Span& fresh,
                               const Span& old) const {
  const bool fresh_behind = fresh_key.lo > old_key.hi - tie, old_behind = old_key.lo > fresh_key.hi - tie;
  if (fresh_behind && old_behind) return fresh.piece->face < old.piece->face ? &fresh : &old;
  return fresh_behind ? &old : old_behind ? &fresh : nullptr;
}

// Writes who is nearest on [x0, x1]; returns whether the new span is anywhere.
bool Visibility::compare(const Span& fresh, const Span& old, double x0, double x1) {
  if (!(x0 < x1)) return false;
  // Neighbours meet at their common border but for rounding.
  if (x1 - x0 < kNegligiblePixels) return show(&old, fresh, x0, x1);
  const double tie = this->tie(old.nearest);
  if (const Span* nearer = decide({fresh.nearest, fresh.farthest}, {old.nearest, old.farthest}, tie, fresh, old)) {
    return show(nearer, fresh, x0, x1);
  }
  const Piece &f = *fresh.piece, &o = *old.piece;
  // Two branches of one cut, on both sides of a fold: along it the key moves one way.
  if (&f == &o && f.key_slope.one_signed() && fresh.plane == old.plane) {
    const bool after = fresh.a0 + fresh.a1 > old.a0 + old.a1;
    return show(after == f.key_slope.positive() ? &old : &fresh, fresh, x0, x1);
  }
  // By the key planes, which are linear along x.
  const double f0 = f.key_plane.key(x0, fresh.y), f1 = f.key_plane.key(x1, fresh.y);
  const double o0 = o.key_plane.key(x0, fresh.y), o1 = o.key_plane.key(x1, fresh.y);
  const double error = f.key_plane.error + o.key_plane.error;
  const Interval difference{std::min(f0 - o0, f1 - o1) - error, std::max(f0 - o0, f1 - o1) + error};
  if (const Span* nearer = decide(difference, {0.0, 0.0}, tie, fresh, old)) return show(nearer, fresh, x0, x1);
  // By both kinds of bounds together: one of the spans may be steep and the other long.
  const auto bound = [](const Span& span, double k0, double k1) {
    const double e = span.piece->key_plane.error;
    return intersect({std::min(k0, k1) - e, std::max(k0, k1) + e}, {span.nearest, span.farthest});
  };
  if (const Span* nearer = decide(bound(fresh, f0, f1), bound(old, o0, o1), tie, fresh, old)) {
    return show(nearer, fresh, x0, x1);
  }
  return compare_points(fresh, old, x0, x1);
}

// Solves both spans at several x and compares them from one to the next.
bool Visibility::compare_points(const Span& fresh, const Span& old, double x0, double x1) {
  constexpr int kLast = SpanKeys::kCount - 1;
  double x[SpanKeys::kCount];
  for (int k = 0; k <= kLast; ++k) x[k] = x0 + (x1 - x0) * k / kLast;
  x[kLast] = x1;
  SpanKeys f, o;
  keys_at(fresh, x, &f);
  keys_at(old, x, &o);
  const auto between = [](const Span& span, const SpanKeys& keys, int k) {
    if (span.piece->planar) {
      return Interval{std::min(keys.key[k], keys.key[k + 1]), std::max(keys.key[k], keys.key[k + 1])};
    }
    return span.key_between(keys.a[k], keys.key[k], keys.a[k + 1], keys.key[k + 1]);
  };
  const bool finest = x1 - x0 <= kLast * kFinestInterval || (fresh.piece->planar && old.piece->planar);
  bool shown = false;
  for (int k = 0; k < kLast; ++k) {
    if (!(x[k] < x[k + 1])) continue;
    const Interval key = between(old, o, k);
    if (const Span* nearer = decide(between(fresh, f, k), key, tie(key.lo), fresh, old)) {
      shown |= show(nearer, fresh, x[k], x[k + 1]);
    } else if (!finest) {
      shown |= compare_points(fresh, old, x[k], x[k + 1]);
    } else {
      shown |= cross(fresh, old, x[k], x[k + 1], f.key[k] - o.key[k], f.key[k + 1] - o.key[k + 1], tie(key.lo));
    }
  }
  return shown;
}

// Who is nearest on a stretch where at most one crossing is looked for, from the key differences at its ends.
bool Visibility::cross(const Span& fresh, const Span& old, double x0, double x1, double d0, double d1, double tie) {
  const bool tie0 = std::fabs(d0) <= tie, tie1 = std::fabs(d1) <= tie;
  if (tie0 || tie1 || (d0 < 0) == (d1 < 0)) {
    // Surfaces that touch at one end are told apart at the other.
    const bool nearer = tie0 && tie1 ? fresh.piece->face < old.piece->face : (tie0 ? d1 : d0) < 0;
    return show(nearer ? &fresh : &old, fresh, x0, x1);
  }
  const double crossing = solve_crossing(fresh, old, x0, x1, d0, d1);
  push(x0, crossing, d0 < 0 ? &fresh : &old);
  push(crossing, x1, d1 < 0 ? &fresh : &old);
  return true;
}

// Where the key difference, of opposite signs at x0 and x1, vanishes.
double Visibility::solve_crossing(const Span& fresh, const Span& old, double x0, double x1, double d0,
                                  double d1) const {
  double a;
  for (int iteration = 0; iteration < 60 && x1 - x0 > kCrossingTolerance; ++iteration) {
    double x = iteration % 3 == 2 ? 0.5 * (x0 + x1) : x0 + (x1 - x0) * d0 / (d0 - d1);
    if (!(x > x0 && x < x1)) x = 0.5 * (x0 + x1);
    const double d = key_at(fresh, x, &a) - key_at(old, x, &a);
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

}  // namespace nofacet
