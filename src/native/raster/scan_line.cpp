#include "raster/scan_line.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kFinestInterval = 0.5;      // pixels
constexpr double kCrossingTolerance = 1e-6;  // pixels

// How far key - c x may be from running evenly with the parameter between the ends of a span.
Interval sag(const Span& span, double c) {
  const Interval bend = span.piece->key_bend - span.piece->x_bend * c;
  const double reach = 0.125 * (span.a1 - span.a0) * (span.a1 - span.a0);
  return {-reach * std::max(bend.hi, 0.0), -reach * std::min(bend.lo, 0.0)};
}

// key = at + slope x, to within `error`, all along a span: its chord or the piece's key plane, whichever is closer.
struct KeyLine {
  double at, slope;
  Interval error;

  explicit KeyLine(const Span& span) {
    const KeyPlane& plane = span.piece->key_plane;
    slope = (span.key1 - span.key0) / (span.x1 - span.x0);
    at = span.key0 - slope * span.x0;
    error = sag(span, slope);  // key - slope x is the same at both ends
    if (2.0 * plane.error <= error.width()) {
      slope = plane.by_x;
      at = plane.key(0.0, span.y);
      error = {-plane.error, plane.error};
    }
  }
  double key(double x) const { return at + slope * x; }
};

// Bounds of key - c (x - origin) along a span.
Interval sheared_key(const Span& span, double c, double origin) {
  const double k0 = span.key0 - c * (span.x0 - origin), k1 = span.key1 - c * (span.x1 - origin);
  const Interval ends{std::min(k0, k1), std::max(k0, k1)};
  return span.piece->key_is_monotone(c) ? ends : ends + sag(span, c);
}

// A shear under which the keys of two spans vary little: both one way, if there is such a shear.
double common_shear(const Piece& fold, const Piece& other) {
  Interval c = fold.shears;
  if (other.kind == CutKind::fold) {
    const Interval both = intersect(c, other.shears);
    return both.lo <= both.hi ? both.mid() : c.mid();
  }
  // Beside the slopes that the other piece has.
  const Interval below{c.lo, std::min(c.hi, other.shears.lo)}, above{std::max(c.lo, other.shears.hi), c.hi};
  const Interval free = above.width() > below.width() ? above : below;
  return free.lo <= free.hi ? free.mid() : c.mid();
}

bool of_one_curve(const Span& p, const Span& q) {
  return p.piece == q.piece && p.plane == q.plane && p.curve == q.curve;
}

// Whether the key grows from the span's left end, or its right end, on.
bool leaves_eye(const Span& span, bool from_left) {
  const double a = from_left ? span.a0 : span.a1, other = from_left ? span.a1 : span.a0;
  const ScreenJet screen(evaluate(span.piece->net, a, from_left ? span.b0 : span.b1));
  const double slope = screen.ka - screen.kb * screen.ya / screen.yb;
  return (slope > 0) == (other > a);
}

auto first_after(const std::vector<VisibleSegment>& segments, double x) {
  return std::upper_bound(segments.begin(), segments.end(), x,
                          [](double value, const VisibleSegment& s) { return value < s.x1; });
}

}  // namespace

bool ScanLine::hides(double x0, double x1, double nearest) const {
  constexpr int kNear = 4;
  std::size_t first = std::min(hint, segments.size());
  int moves = 0;
  while (first > 0 && segments[first - 1].x1 > x0 && moves++ < kNear) --first;
  while (first < segments.size() && segments[first].x1 <= x0 && moves++ < kNear) ++first;
  if (moves > kNear) first = first_after(segments, x0) - segments.begin();
  hint = first;
  double cursor = x0;
  for (auto it = segments.begin() + std::ptrdiff_t(first); it != segments.end() && it->x0 <= cursor; ++it) {
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
  // By what is linear along x.
  const KeyLine f_line(fresh), o_line(old);
  const double f0 = f_line.key(x0), f1 = f_line.key(x1), o0 = o_line.key(x0), o1 = o_line.key(x1);
  const Interval difference = Interval{std::min(f0 - o0, f1 - o1), std::max(f0 - o0, f1 - o1)} + f_line.error - o_line.error;
  if (const Span* nearer = decide(difference, {0.0, 0.0}, tie, fresh, old)) return show(nearer, fresh, x0, x1);
  // By both kinds of bounds together: one of the spans may be steep and the other long.
  const auto bound = [](const Span& span, double k0, double k1, Interval e) {
    return intersect(Interval{std::min(k0, k1), std::max(k0, k1)} + e, {span.nearest, span.farthest});
  };
  if (const Span* nearer =
          decide(bound(fresh, f0, f1, f_line.error), bound(old, o0, o1, o_line.error), tie, fresh, old)) {
    return show(nearer, fresh, x0, x1);
  }
  // Both sides of a fold are on one side each of where they meet, seen along a slope that the surface has nowhere there.
  for (const Span* span : {&fresh, &old}) {
    const Span& other = span == &fresh ? old : fresh;
    if (span->piece->kind != CutKind::fold || !(span->piece->shears.lo <= span->piece->shears.hi)) continue;
    const double c = common_shear(*span->piece, *other.piece);
    if (const Span* nearer = decide(sheared_key(fresh, c, x0), sheared_key(old, c, x0), tie, fresh, old)) {
      return show(nearer, fresh, x0, x1);
    }
  }
  return compare_points(fresh, old, x0, x1);
}

// Solves both spans at several x and compares them from one to the next.
bool Visibility::compare_points(const Span& fresh, const Span& old, double x0, double x1) {
  constexpr int kCount = 4, kLast = kCount - 1;
  double x[kCount];
  const bool from_fold = (fresh.fold0 && x0 <= fresh.x0) || (old.fold0 && x0 <= old.x0);
  const bool to_fold = (fresh.fold1 && x1 >= fresh.x1) || (old.fold1 && x1 >= old.x1);
  for (int k = 0; k <= kLast; ++k) {
    double t = double(k) / kLast;
    if (from_fold != to_fold) t *= from_fold ? t : 2.0 - t;  // a span's parameter goes with the root of x there
    x[k] = x0 + (x1 - x0) * t;
  }
  x[kLast] = x1;
  SpanKeys f, o;
  keys_at(fresh, x, kCount, &f);
  keys_at(old, x, kCount, &o);
  const auto between = [](const Span& span, const SpanKeys& keys, int k) {
    if (span.piece->planar) {
      return Interval{std::min(keys.key[k], keys.key[k + 1]), std::max(keys.key[k], keys.key[k + 1])};
    }
    return span.key_between(keys.a[k], keys.key[k], keys.a[k + 1], keys.key[k + 1]);
  };
  const bool linear = fresh.piece->planar && old.piece->planar;
  bool shown = false;
  for (int k = 0; k < kLast; ++k) {
    if (!(x[k] < x[k + 1])) continue;
    const Interval key = between(old, o, k);
    if (const Span* nearer = decide(between(fresh, f, k), key, tie(key.lo), fresh, old)) {
      shown |= show(nearer, fresh, x[k], x[k + 1]);
    } else if (x[k + 1] - x[k] > kFinestInterval && !linear) {
      shown |= compare_points(fresh, old, x[k], x[k + 1]);
    } else {
      const KeyDifference left{x[k], f.key[k] - o.key[k]}, right{x[k + 1], f.key[k + 1] - o.key[k + 1]};
      shown |= cross(fresh, old, left, right, tie(key.lo));
    }
  }
  return shown;
}

// Who is nearest between two x where at most one crossing is looked for.
bool Visibility::cross(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right, double tie) {
  const bool tie_left = std::fabs(left.d) <= tie, tie_right = std::fabs(right.d) <= tie;
  const double x0 = left.x, x1 = right.x;
  if (tie_left && tie_right) return show(fresh.piece->face < old.piece->face ? &fresh : &old, fresh, x0, x1);
  const bool at_fold = tie_left ? fresh.fold0 && x0 <= fresh.x0 : fresh.fold1 && x1 >= fresh.x1;
  if ((tie_left || tie_right) && at_fold && of_one_curve(fresh, old)) {
    // Two sides of a fold: the way the key goes there tells who is nearer beside it.
    const double d = tie_left ? right.d : left.d;
    if (leaves_eye(fresh, tie_left) == (d > 0)) return show(d < 0 ? &fresh : &old, fresh, x0, x1);
  }
  // Surfaces that touch at one end are told apart at the other, but they may cross beside the touch.
  if (tie_left) left = leave_touch(fresh, old, x0, &right, tie);
  if (tie_right) right = leave_touch(fresh, old, x1, &left, tie);
  if ((left.d < 0) == (right.d < 0)) return show(left.d < 0 ? &fresh : &old, fresh, x0, x1);
  const double crossing = solve_crossing(fresh, old, left, right);
  push(x0, crossing, left.d < 0 ? &fresh : &old);
  push(crossing, x1, right.d < 0 ? &fresh : &old);
  return true;
}

// Follows the key difference of two spans that touch at `end` towards there, in ever shorter steps, the last of which
// ends below 1e-5 px from it. *far moves along while the sign stays; returns where it is no longer the same, or the
// end.
Visibility::KeyDifference Visibility::leave_touch(const Span& fresh, const Span& old, double end, KeyDifference* far,
                                                  double tie) const {
  constexpr int kCount = SpanKeys::kMost;
  const bool ascending = end < far->x;
  const auto index = [&](int step) { return ascending ? kCount - 1 - step : step; };
  double x[kCount], distance = far->x - end;
  for (int step = 0; step < kCount; ++step) x[index(step)] = end + (distance *= 0.25);
  SpanKeys f, o;
  keys_at(fresh, x, kCount, &f);
  keys_at(old, x, kCount, &o);
  for (int step = 0; step < kCount; ++step) {
    const int k = index(step);
    const KeyDifference next{x[k], f.key[k] - o.key[k]};
    if (std::fabs(next.d) <= tie) break;
    if ((next.d < 0) != (far->d < 0)) return next;
    *far = next;
  }
  return {end, far->d};
}

// Where the key difference, of opposite signs at two x, vanishes.
double Visibility::solve_crossing(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right) const {
  double a;
  for (int iteration = 0; iteration < 60 && right.x - left.x > kCrossingTolerance; ++iteration) {
    double x = 0.5 * (left.x + right.x);
    if (iteration % 3 != 2) {
      const double secant = left.x + (right.x - left.x) * left.d / (left.d - right.d);
      if (secant > left.x && secant < right.x) x = secant;
    }
    const double d = key_at(fresh, x, &a) - key_at(old, x, &a);
    if (d == 0.0) return x;
    KeyDifference& moved = (d < 0) == (left.d < 0) ? left : right;
    if (std::fabs(x - moved.x) < kCrossingTolerance) return x;
    moved = {x, d};
  }
  return 0.5 * (left.x + right.x);
}

}  // namespace nofacet
