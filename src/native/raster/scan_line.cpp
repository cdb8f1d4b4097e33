#include "raster/scan_line.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kFinestInterval = 0.5;      // pixels
constexpr double kCrossingTolerance = 1e-6;  // pixels

// Bounds of key - c (x - origin) along a span.
Interval sheared_key(const Span& span, double c, double origin) {
  const double k0 = span.key0 - c * (span.x0 - origin), k1 = span.key1 - c * (span.x1 - origin);
  const Interval ends{std::min(k0, k1), std::max(k0, k1)};
  return span.piece->key_is_monotone(c) ? ends : ends + sag(*span.piece, span.a0, span.a1, c);
}

// Bounds of key - c (x - x[k]) along a span between two of its points.
Interval sheared_key_between(const Span& span, const SpanKeys& keys, const double* x, int k, double c) {
  const double length = x[k + 1] - x[k], k0 = keys.key[k], k1 = keys.key[k + 1] - c * length;
  const Interval ends{std::min(k0, k1), std::max(k0, k1)};
  const Piece& piece = *span.piece;
  if (piece.planar) return ends;
  Interval key = ends + sag(piece, keys.a[k], keys.a[k + 1], c);
  // Lines from both ends, by the slopes that there are, meet at the lowest and highest point.
  const Interval slopes = key_slopes(span) - c;
  if (slopes.lo >= 0 || slopes.hi <= 0) return ends;
  if (std::isfinite(slopes.lo) && std::isfinite(slopes.hi)) {
    const double mean = (k1 - k0) / length, share = (mean - slopes.hi) / (slopes.lo - slopes.hi);
    key = intersect(key, {k0 + slopes.lo * share * length, k1 - slopes.lo * share * length});
  }
  return key;
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

// Whether all that is no nearer than `near` is behind all that is no farther than `far` between two x, but for where
// they touch.
bool is_behind(const KeyLine& near, const KeyLine& far, double x0, double x1, double tie) {
  return near.key(x0) - far.key(x0) > -tie && near.key(x1) - far.key(x1) > -tie;
}

}  // namespace

std::size_t ScanLine::first_after(double x) const {
  constexpr int kNear = 4;
  std::size_t first = std::min(hint, segments.size());
  int moves = 0;
  while (first > 0 && segments[first - 1].x1 > x && moves++ < kNear) --first;
  while (first < segments.size() && segments[first].x1 <= x && moves++ < kNear) ++first;
  if (moves > kNear) {
    first = std::upper_bound(segments.begin(), segments.end(), x,
                             [](double value, const VisibleSegment& s) { return value < s.x1; }) -
            segments.begin();
  }
  return hint = first;
}

bool ScanLine::hides(Interval x, double nearest, const KeyLine& near, double tie) const {
  if (!(x.lo < x.hi)) return true;
  // Touching surfaces may be one surface only if they touch at both ends.
  const auto is_hidden_by = [&](const Span& span, double x0, double x1) {
    if (span.farthest < nearest - tie) return true;
    const KeyLines lines(span);
    for (int k = 0; k < lines.far_count; ++k) {
      const double d0 = near.key(x0) - lines.far[k].key(x0), d1 = near.key(x1) - lines.far[k].key(x1);
      if (std::min(d0, d1) > -tie && std::max(d0, d1) > tie) return true;
    }
    return false;
  };
  double cursor = x.lo;
  for (std::size_t k = first_after(x.lo); k < segments.size(); ++k) {
    const VisibleSegment& segment = segments[k];
    // Neighbours meet but for rounding.
    if (segment.x0 > cursor + kNegligiblePixels) return false;
    if (!is_hidden_by(*segment.span, cursor, std::min(segment.x1, x.hi))) return false;
    if (segment.x1 >= x.hi) return true;
    cursor = segment.x1;
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
  const auto before = [](const Interval& p, const Interval& q) { return p.lo < q.lo; };
  if (!std::is_sorted(stretches.begin(), stretches.end(), before)) {  // mostly they are
    std::sort(stretches.begin(), stretches.end(), before);
  }
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

bool Visibility::insert(const Span& span, ScanLine& line) {
  std::vector<VisibleSegment>& segments = line.segments;
  const double x0 = std::max(span.x0, 0.0), x1 = std::min(span.x1, double(camera_.width));
  if (!(x0 < x1)) return false;
  const std::size_t first = line.first_after(x0);
  if (first == segments.size() || segments[first].x0 >= x1) {
    segments.insert(segments.begin() + std::ptrdiff_t(first), {x0, x1, &span});
    return true;
  }
  const std::size_t last = merge(span, segments, first);
  if (!shown_) return false;
  const std::size_t count = last - first, size = merged_.size();
  const auto begin = segments.begin() + std::ptrdiff_t(first);
  if (size > count) {
    segments.insert(begin, size - count, {});
  } else {
    segments.erase(begin, begin + std::ptrdiff_t(count - size));
  }
  std::copy(merged_.begin(), merged_.end(), segments.begin() + std::ptrdiff_t(first));
  return true;
}

void Visibility::append_visible(const Span& span, const ScanLine& line, std::vector<VisibleSegment>& out) {
  merge(span, line.segments, line.first_after(std::max(span.x0, 0.0)));
  for (const VisibleSegment& segment : merged_) {
    if (segment.span == &span) out.push_back(segment);
  }
}

// Writes to merged_ what replaces the segments that the span overlaps, from `first` on, and to shown_ whether it is in
// it; returns the end of these segments.
std::size_t Visibility::merge(const Span& span, const std::vector<VisibleSegment>& segments, std::size_t first) {
  double cursor = std::max(span.x0, 0.0);
  const double end = std::min(span.x1, double(camera_.width));
  merged_.clear();
  shown_ = false;
  // What neighbours leave between them by rounding is nobody's.
  const auto fill = [&](double to) {
    if (to - cursor < kNegligiblePixels) return;
    push(cursor, to, &span);
    shown_ = true;
  };
  std::size_t k = first;
  for (; k < segments.size() && segments[k].x0 < end; ++k) {
    const VisibleSegment& old = segments[k];
    if (cursor < old.x0) {
      fill(old.x0);
      cursor = old.x0;
    }
    push(old.x0, cursor, old.span);
    const double overlap_end = std::min(old.x1, end);
    shown_ |= compare(span, *old.span, cursor, overlap_end);
    push(overlap_end, old.x1, old.span);
    cursor = overlap_end;
  }
  if (cursor < end) fill(end);
  return k;
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

// Surfaces that are each behind the other are one and the same: then the face with the lower index is nearest.
const Span* Visibility::decide(bool fresh_behind, bool old_behind, const Span& fresh, const Span& old) const {
  if (fresh_behind && old_behind) return fresh.piece->face < old.piece->face ? &fresh : &old;
  return fresh_behind ? &old : old_behind ? &fresh : nullptr;
}

// Who is nearest if the keys lie in these ranges; null if they do not tell. Ranges that only touch do: surfaces may
// meet at an edge.
const Span* Visibility::decide(Interval fresh_key, Interval old_key, double tie, const Span& fresh,
                               const Span& old) const {
  return decide(fresh_key.lo > old_key.hi - tie, old_key.lo > fresh_key.hi - tie, fresh, old);
}

// By what bounds the keys linearly along x.
const Span* Visibility::decide_by_lines(const Span& fresh, const Span& old, double x0, double x1, double tie) const {
  const KeyLines f(fresh), o(old);
  const auto behind = [&](const KeyLines& p, const KeyLines& q) {
    for (int i = 0; i < p.near_count; ++i) {
      for (int j = 0; j < q.far_count; ++j) {
        if (is_behind(p.near[i], q.far[j], x0, x1, tie)) return true;
      }
    }
    return false;
  };
  if (const Span* nearer = decide(behind(f, o), behind(o, f), fresh, old)) return nearer;
  // By both kinds of bounds together: one of the spans may be steep and the other long.
  const auto range = [&](const Span& span, const KeyLines& lines) {
    const double n0 = lines.near[0].key(x0), n1 = lines.near[0].key(x1);
    const double f0 = lines.far[0].key(x0), f1 = lines.far[0].key(x1);
    return intersect({std::min(n0, n1), std::max(f0, f1)}, {span.nearest, span.farthest});
  };
  return decide(range(fresh, f), range(old, o), tie, fresh, old);
}

// Both sides of a fold are on one side each of where they meet, seen along a slope that the surface has nowhere there.
const Span* Visibility::decide_by_shears(const Span& fresh, const Span& old, double x0, double tie) const {
  for (const Span* span : {&fresh, &old}) {
    const Span& other = span == &fresh ? old : fresh;
    if (span->piece->kind != CutKind::fold || !(span->piece->shears.lo <= span->piece->shears.hi)) continue;
    const double c = common_shear(*span->piece, *other.piece);
    if (const Span* nearer = decide(sheared_key(fresh, c, x0), sheared_key(old, c, x0), tie, fresh, old)) {
      return nearer;
    }
  }
  return nullptr;
}

// Writes who is nearest on [x0, x1]; returns whether the new span is anywhere.
bool Visibility::compare(const Span& fresh, const Span& old, double x0, double x1) {
  if (!(x0 < x1)) return false;
  // Neighbours meet at their common border but for rounding.
  if (x1 - x0 < kNegligiblePixels) return show(&old, fresh, x0, x1);
  const double tie = this->tie(old.nearest);
  const Span* nearer = decide({fresh.nearest, fresh.farthest}, {old.nearest, old.farthest}, tie, fresh, old);
  if (!nearer) nearer = decide_by_lines(fresh, old, x0, x1, tie);
  if (!nearer) nearer = decide_by_shears(fresh, old, x0, tie);
  return nearer ? show(nearer, fresh, x0, x1) : compare_points(fresh, old, x0, x1);
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
  const bool linear = fresh.piece->planar && old.piece->planar;
  bool shown = false;
  for (int k = 0; k < kLast; ++k) {
    if (!(x[k] < x[k + 1])) continue;
    // Along the old span's chord both keys vary little.
    const double c = (o.key[k + 1] - o.key[k]) / (x[k + 1] - x[k]), tie = this->tie(o.key[k]);
    const auto plain = [&](const Span& span, const SpanKeys& keys) {
      return span.key_between(keys.a[k], keys.key[k], keys.a[k + 1], keys.key[k + 1]);
    };
    const Span* nearer = decide(plain(fresh, f), plain(old, o), tie, fresh, old);
    if (!nearer)
      nearer = decide(sheared_key_between(fresh, f, x, k, c), sheared_key_between(old, o, x, k, c), tie, fresh, old);
    if (nearer) {
      shown |= show(nearer, fresh, x[k], x[k + 1]);
    } else if (x[k + 1] - x[k] > kFinestInterval && !linear) {
      shown |= compare_points(fresh, old, x[k], x[k + 1]);
    } else {
      const KeyDifference left{x[k], f.key[k] - o.key[k]}, right{x[k + 1], f.key[k + 1] - o.key[k + 1]};
      shown |= cross(fresh, old, left, right, tie);
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

// Where the key difference, of opposite signs at two x, vanishes. Several x are solved at once, about where its chord
// vanishes, from which it bends away with the square of their distance; every third time evenly, so that it ends.
double Visibility::solve_crossing(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right) const {
  constexpr int kCount = 4;
  const auto chord_root = [&] { return left.x + (right.x - left.x) * left.d / (left.d - right.d); };
  if (fresh.piece->planar && old.piece->planar) return chord_root();
  for (int round = 0; round < 60 && right.x - left.x > kCrossingTolerance; ++round) {
    const double width = right.x - left.x, middle = chord_root();
    const double far = std::min(0.25 * width, std::max(0.25 * width * width, kCrossingTolerance));
    const double near = std::min(0.25 * far, std::max(0.0625 * far, 0.4 * kCrossingTolerance));
    const double steps[kCount] = {-far, -near, near, far};
    double x[kCount];
    for (int k = 0; k < kCount; ++k) {
      const double even = left.x + width * (k + 1) / (kCount + 1);
      x[k] = round % 3 == 2 ? even : std::clamp(middle + steps[k], left.x, right.x);
    }
    SpanKeys f, o;
    keys_at(fresh, x, kCount, &f);
    keys_at(old, x, kCount, &o);
    for (int k = 0; k < kCount; ++k) {
      const KeyDifference next{x[k], f.key[k] - o.key[k]};
      if (next.d == 0.0) return next.x;
      if ((next.d < 0) != (left.d < 0)) {
        right = next;
        break;
      }
      left = next;
    }
  }
  return chord_root();
}

}  // namespace nofacet
