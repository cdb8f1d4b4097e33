#include "extract/corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace nofacet {
namespace {

// A corner lies within this many gap widths of both ends: where the edges themselves cross, and where tangents do.
constexpr double kCrossingReach = 30.0, kReach = 2.0;
// A tangent longer than this part of the other edge's overshoot is no corner: the link is as good.
constexpr double kShort = 0.2;
// Tangents that together are less than this many gap widths long run along the link: the link is as good.
constexpr double kDetour = 1.1;
// A corner within this part of the gap from an end is that end.
constexpr double kSame = 1e-6;
// Curves that stray from their chord by less than this part of it are straight for a first guess.
constexpr double kFlat = 0.02;
// Directions whose cross product is this small beside its terms are parallel.
constexpr double kParallel = 1e-12;
// Pairs of parts looked at for crossings of two segments: edges that run on top of each other would take for ever.
constexpr int kPairs = 400;

using Points = std::vector<LoopPoint>;

struct Plane {
  double u, v;
};

Plane plane(const LoopPoint& p) { return {p.u / p.w, p.v / p.w}; }

// A segment of a run, by its index, and a parameter of it.
struct Place {
  std::size_t segment;
  double t;
};

// Part of what can hold a corner: a segment of a run, or the tangent beyond the run's end.
struct TailPart {
  std::optional<std::size_t> segment;
  Points points;
};
using Tail = std::vector<TailPart>;

// Where two runs meet, and where each is cut if it is.
struct Corner {
  LoopPoint point;
  std::optional<Place> cuts[2];
};

// The two ends that do not meet, their distance, and 1 / width, 1 / height of the box that lengths are parts of.
struct Gap {
  LoopPoint ends[2];
  double scale_u, scale_v, width;

  Gap(const LoopPoint& end, const LoopPoint& start, double box_width, double box_height)
      : ends{end, start}, scale_u(1 / box_width), scale_v(1 / box_height), width(length(end, start)) {}

  double length(const LoopPoint& one, const LoopPoint& other) const {
    return std::hypot((one.u / one.w - other.u / other.w) * scale_u, (one.v / one.w - other.v / other.w) * scale_v);
  }
  double both(const LoopPoint& p) const { return length(p, ends[0]) + length(p, ends[1]); }
};

// One step of de Casteljau's algorithm, in place.
void shorten(Points& points, double t) {
  const double r = 1.0 - t;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const LoopPoint &a = points[k], &b = points[k + 1];
    points[k] = {r * a.u + t * b.u, r * a.v + t * b.v, r * a.w + t * b.w};
  }
  points.pop_back();
}

// Of a rational Bezier segment at t, where the weight is not 0; t may lie outside [0, 1].
std::pair<Plane, Plane> point_and_derivative(Points points, double t) {
  const double degree = double(points.size()) - 1;
  while (points.size() > 2) shorten(points, t);
  const LoopPoint a = points[0], b = points[1];
  shorten(points, t);
  const LoopPoint p = points[0];
  const double factor = degree * a.w * b.w / (p.w * p.w);
  return {plane(p), {factor * (b.u / b.w - a.u / a.w), factor * (b.v / b.w - a.v / a.w)}};
}

// The parts of a Bezier segment up to t and from t on.
std::pair<Points, Points> split(Points points, double t) {
  Points low{points.front()}, high{points.back()};
  while (points.size() > 1) {
    shorten(points, t);
    low.push_back(points.front());
    high.push_back(points.back());
  }
  std::reverse(high.begin(), high.end());
  return {low, high};
}

// The first point and the way from there to the last.
std::pair<Plane, Plane> chord(const Points& points) {
  const Plane first = plane(points.front()), last = plane(points.back());
  return {first, {last.u - first.u, last.v - first.v}};
}

// How far the control points are from even spacing along the chord, in parts of its length: 0 for a line.
double bend(const Points& points, const Gap& gap) {
  const std::size_t degree = points.size() - 1;
  if (degree == 1) return 0.0;
  const auto [first, way] = chord(points);
  double off = 0.0;
  for (std::size_t k = 1; k < degree; ++k) {
    const double part = double(k) / double(degree);
    off = std::max(off, gap.length({first.u + part * way.u, first.v + part * way.v, 1.0}, points[k]));
  }
  const double length = gap.length(points.front(), points.back());
  return length != 0.0 ? off / length : std::numeric_limits<double>::infinity();
}

// Whether the boxes of the control points do not touch.
bool apart(const Points& one, const Points& two) {
  for (const auto coordinate : {&Plane::u, &Plane::v}) {
    auto range = [&](const Points& points) {
      double low = plane(points[0]).*coordinate, high = low;
      for (const LoopPoint& p : points) {
        const double x = plane(p).*coordinate;
        low = std::min(low, x), high = std::max(high, x);
      }
      return std::pair(low, high);
    };
    const auto [low_one, high_one] = range(one);
    const auto [low_two, high_two] = range(two);
    if (low_one > high_two || high_one < low_two) return true;
  }
  return false;
}

// s, t with p + s dp = q + t dq; nothing for parallel directions.
std::optional<std::pair<double, double>> step(const std::pair<Plane, Plane>& one, const std::pair<Plane, Plane>& two) {
  const auto [p, dp] = one;
  const auto [q, dq] = two;
  const double determinant = dp.v * dq.u - dp.u * dq.v;
  if (std::abs(determinant) <= kParallel * (std::abs(dp.v * dq.u) + std::abs(dp.u * dq.v))) return {};
  const double du = q.u - p.u, dv = q.v - p.v;
  return std::pair((dv * dq.u - du * dq.v) / determinant, (dv * dp.u - du * dp.v) / determinant);
}

// Newton's method from a guess at a crossing's parameters; nothing where it leaves the segments or does not settle.
std::optional<std::pair<double, double>> polished(const Points& one, const Points& two, double s, double t) {
  for (int k = 0; k < 12; ++k) {
    const auto move = step(point_and_derivative(one, s), point_and_derivative(two, t));
    if (!move) return {};
    s += move->first, t += move->second;
    if (!(-0.5 <= s && s <= 1.5 && -0.5 <= t && t <= 1.5)) return {};
    if (std::max(std::abs(move->first), std::abs(move->second)) <= 1e-13) {
      const bool inside = -1e-9 <= s && s <= 1 + 1e-9 && -1e-9 <= t && t <= 1 + 1e-9;
      if (!inside) return {};
      return std::pair(std::clamp(s, 0.0, 1.0), std::clamp(t, 0.0, 1.0));
    }
  }
  return {};
}

// Parameters of the points where two rational Bezier segments cross.
std::vector<std::pair<double, double>> crossings(const Points& one, const Points& two, const Gap& gap) {
  struct Pair {
    Points p;
    double s0, s1;
    Points q;
    double t0, t1;
  };
  std::vector<std::pair<double, double>> found;
  std::vector<Pair> stack{{one, 0.0, 1.0, two, 0.0, 1.0}};
  for (int k = 0; k < kPairs && !stack.empty(); ++k) {
    const Pair part = std::move(stack.back());
    const auto& [p, s0, s1, q, t0, t1] = part;
    stack.pop_back();
    if (apart(p, q)) continue;
    const double bend_p = bend(p, gap), bend_q = bend(q, gap);
    if (std::max(bend_p, bend_q) <= kFlat) {
      const auto guess = step(chord(p), chord(q));
      auto near = [](double x) { return -0.1 <= x && x <= 1.1; };
      if (!guess || !near(guess->first) || !near(guess->second)) continue;
      if (const auto place = polished(one, two, s0 + guess->first * (s1 - s0), t0 + guess->second * (t1 - t0))) {
        found.push_back(*place);
      }
    } else if (bend_p >= bend_q) {
      const double middle = 0.5 * (s0 + s1);
      auto [low, high] = split(p, 0.5);
      stack.push_back({std::move(high), middle, s1, q, t0, t1});
      stack.push_back({std::move(low), s0, middle, q, t0, t1});
    } else {
      const double middle = 0.5 * (t0 + t1);
      auto [low, high] = split(q, 0.5);
      stack.push_back({p, s0, s1, std::move(high), middle, t1});
      stack.push_back({p, s0, s1, std::move(low), t0, middle});
    }
  }
  return found;
}

// The segments of the run's last edge that can hold a corner, the last one first.
Tail tail_of(const TrimLoop& run, const Gap& gap) {
  const LoopPoint& end = run.back().points.back();
  Tail tail;
  for (std::size_t k = run.size(); k-- > 0 && run[k].edge == run.back().edge;) {
    tail.push_back({k, run[k].points});
    if (gap.length(run[k].points.front(), end) > kCrossingReach * gap.width) break;
  }
  return tail;
}

// The straight segment that leads on from a curve's end as far as a corner may lie.
Tail tangent_of(const Points& points, const Gap& gap) {
  const LoopPoint& end = points.back();
  for (std::size_t k = points.size() - 1; k-- > 0;) {
    const double length = gap.length(points[k], end);
    if (length <= kSnap) continue;
    const double factor = 1.01 * kReach * gap.width / length;
    const Plane from = plane(points[k]);
    return {{{}, {end, {end.u + factor * (end.u - from.u), end.v + factor * (end.v - from.v), 1.0}}}};
  }
  return {};
}

// Crossings at most `reach` gap widths from both ends.
std::vector<Corner> corners_of(const Tail& one, const Tail& two, const Gap& gap, double reach) {
  std::vector<Corner> corners;
  for (const TailPart& a : one) {
    for (const TailPart& b : two) {
      for (const auto& [s, t] : crossings(a.points, b.points, gap)) {
        const Plane p = point_and_derivative(a.points, s).first;
        Corner corner{{p.u, p.v, 1.0}, {}};
        if (std::max(gap.length(corner.point, gap.ends[0]), gap.length(corner.point, gap.ends[1])) >
            reach * gap.width) {
          continue;
        }
        if (a.segment) corner.cuts[0] = {*a.segment, s};
        if (b.segment) corner.cuts[1] = {*b.segment, t};
        corners.push_back(corner);
      }
    }
  }
  return corners;
}

// Corners on tangents: where both meet, or where one meets the other edge, which overshoots.
std::vector<Corner> corners_on_tangents(const TrimLoop& one, const TrimLoop& two, const Tail (&tails)[2],
                                        const Gap& gap) {
  const Tail tangents[2] = {tangent_of(one.back().points, gap), tangent_of(two.back().points, gap)};
  std::vector<Corner> corners = corners_of(tangents[0], tangents[1], gap, kReach);
  std::erase_if(corners, [&](const Corner& corner) { return gap.both(corner.point) < kDetour * gap.width; });
  for (const int over : {0, 1}) {
    const int brief = 1 - over;
    const auto found = corners_of(over == 0 ? tails[0] : tangents[0], over == 1 ? tails[1] : tangents[1], gap, kReach);
    for (const Corner& corner : found) {
      if (gap.length(corner.point, gap.ends[brief]) <= kShort * gap.length(corner.point, gap.ends[over])) {
        corners.push_back(corner);
      }
    }
  }
  return corners;
}

// Where two runs that end at a gap meet, and the places to cut each at: none for a run that ends short of it.
std::optional<Corner> corner_of(const TrimLoop& one, const TrimLoop& two, const Gap& gap) {
  const Tail tails[2] = {tail_of(one, gap), tail_of(two, gap)};
  std::vector<Corner> corners = corners_of(tails[0], tails[1], gap, kCrossingReach);
  if (corners.empty()) corners = corners_on_tangents(one, two, tails, gap);
  if (corners.empty()) return {};
  Corner best = *std::min_element(corners.begin(), corners.end(), [&](const Corner& a, const Corner& b) {
    return gap.both(a.point) < gap.both(b.point);
  });
  for (const int k : {0, 1}) {
    if (gap.length(best.point, gap.ends[k]) > kSame * gap.width) continue;
    best.point = gap.ends[k];
    best.cuts[k].reset();
    break;
  }
  return best;
}

// Cuts the run at a place; its last point becomes `point`, which is that place but for rounding.
void cut(TrimLoop& run, const Place& place, const LoopPoint& point) {
  run.resize(place.segment + 1);
  Points& points = run.back().points;
  points = split(points, place.t).first;
  // a Moebius change of parameter makes the end weight 1 and leaves the curve as it is
  const double ratio = std::pow(points.back().w, -1.0 / double(points.size() - 1));
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double factor = std::pow(ratio, double(k));
    points[k] = {points[k].u * factor, points[k].v * factor, points[k].w * factor};
  }
  points.back() = point;
}

// The same segments run through the other way.
void reverse(TrimLoop& run) {
  std::reverse(run.begin(), run.end());
  for (TrimSegment& segment : run) std::reverse(segment.points.begin(), segment.points.end());
}

TrimSegment link(const LoopPoint& from, const LoopPoint& to) { return {{from, to}, -1, false}; }

// Cuts the runs on both sides of a gap at their corner; returns the segments that lead from the first to the second.
TrimLoop join(TrimLoop& before, TrimLoop& after, double width, double height) {
  // seen from the gap, the run that follows is another one that ends there
  TrimLoop other = after;
  reverse(other);
  const LoopPoint end = before.back().points.back(), start = other.back().points.back();
  const Gap gap(end, start, width, height);
  std::optional<Corner> corner;
  if (!before.back().at_pole && gap.width >= kNarrowestCorner && gap.width <= kWidestCorner) {
    corner = corner_of(before, other, gap);
  }
  if (!corner) return {link(end, start)};
  TrimLoop between;
  if (corner->cuts[0]) {
    cut(before, *corner->cuts[0], corner->point);
  } else if (corner->point != end) {
    between.push_back(link(end, corner->point));
  }
  if (corner->cuts[1]) {
    cut(other, *corner->cuts[1], corner->point);
    reverse(other);
    after = std::move(other);
  } else if (corner->point != start) {
    between.push_back(link(corner->point, start));
  }
  return between;
}

bool near(const LoopPoint& one, const LoopPoint& other, double du, double dv) {
  return std::abs(one.u - other.u) <= du && std::abs(one.v - other.v) <= dv;
}

// The loop's segments up to each gap, small gaps moved away.
std::vector<TrimLoop> runs_of(TrimLoop loop, double du, double dv) {
  std::vector<TrimLoop> runs(1);
  LoopPoint end = loop.front().points.front();
  for (TrimSegment& segment : loop) {
    LoopPoint& start = segment.points.front();
    if (start != end) {
      if (near(start, end, du, dv)) {
        start = end;
      } else {
        runs.emplace_back();
      }
    }
    end = segment.points.back();
    runs.back().push_back(std::move(segment));
  }
  return runs;
}

void append(TrimLoop& loop, TrimLoop&& part) {
  loop.insert(loop.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
}

}  // namespace

TrimLoop weld(TrimLoop loop, double width, double height) {
  const std::size_t count = loop.size();
  std::vector<TrimLoop> runs = runs_of(std::move(loop), kSnap * width, kSnap * height);
  LoopPoint& end = runs.back().back().points.back();
  const LoopPoint start = runs.front().front().points.front();
  if (start != end && count > 1 && near(start, end, kSnap * width, kSnap * height)) end = start;
  const bool closed = start == end;
  TrimLoop result;
  if (runs.size() == 1) {
    if (closed) return std::move(runs[0]);
    if (count == 1) {
      runs[0].push_back(link(end, start));
      return std::move(runs[0]);
    }
    // a single gap: both its sides are the same run
    const auto half = runs[0].begin() + std::ptrdiff_t(count / 2);
    TrimLoop after(runs[0].begin(), half), before(half, runs[0].end());
    TrimLoop between = join(before, after, width, height);
    result = std::move(after);
    append(result, std::move(before));
    append(result, std::move(between));
    return result;
  }
  std::vector<TrimLoop> links(runs.size());
  for (std::size_t k = 0; k < (closed ? runs.size() - 1 : runs.size()); ++k) {
    links[k] = join(runs[k], runs[(k + 1) % runs.size()], width, height);
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    append(result, std::move(runs[k]));
    append(result, std::move(links[k]));
  }
  return result;
}

}  // namespace nofacet
