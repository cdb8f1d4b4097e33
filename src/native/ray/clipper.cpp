#include "ray/clipper.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace nofacet {
namespace {

// A clip that leaves more than this part of the area is not worth making, or has stalled.
constexpr double kWorthClipping = 0.7;
// Certified parts this straight are solved without clipping them further: guesses are good enough. For few rays any
// certified part is, for clipping costs more than the steps it saves.
constexpr double kStraight = 0.12;
constexpr int kRaysWorthClipping = 16;
// Half the width of a bundle of one row or column of rays, in distances of rays: clipping it to a line pays nothing.
constexpr double kRowWidth = 0.25;
// A part of less than this many times the rounding of its control points is a point.
constexpr double kTooSmall = 10.0;
// Half the width that a single ray is given, in parts of the rounding of coordinates.
constexpr double kThinnest = 1e5;
// Where so few rays are left and there is no certificate they go on one by one.
constexpr int kFewRays = 4;

// What a net's control points say of where it is on the screen.
struct ScreenHull {
  Interval w = Interval::empty(), x = w, y = w;
  double nearest = INFINITY;

  ScreenHull(const Net& net, const RayPatch& patch) {
    for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) w.include(p[kW]);
    if (!(w.lo > 0.0)) return;
    const int numerator = patch.depth_numerator(), denominator = patch.depth_denominator();
    for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
      const double r = 1.0 / p[kW];
      x.include(p[kX] * r);
      y.include(p[kY] * r);
      nearest = std::min(nearest, p[numerator] / p[denominator]);
    }
  }
  bool behind() const { return w.hi <= 0.0; }
  bool crosses_eye_plane() const { return !(w.lo > 0.0); }
};

// `thinnest`: a part clipped to less than this would be as thin as the rounding of its control points.
RayBundle bundle_of(const RayGrid& grid, const RayRect& rect, double thinnest) {
  const double x0 = grid.x(rect.i0), x1 = grid.x(rect.i1 - 1), y0 = grid.y(rect.j0), y1 = grid.y(rect.j1 - 1);
  const double least = std::max(thinnest, rect.count() > 1 ? kRowWidth * grid.step : 0.0);
  return {0.5 * (x0 + x1), 0.5 * (y0 + y1), std::max(least, 0.5 * (x1 - x0)), std::max(least, 0.5 * (y1 - y0))};
}

// The net between two parallel lines along its longer side: how it looks when it is seen nearly edge-on.
struct Strip {
  double x, y, offset_lo = INFINITY, offset_hi = -INFINITY;  // unit normal and range of offsets

  explicit Strip(const Net& net) {
    const double* origin = net.points;
    const double ox = origin[kX] / origin[kW], oy = origin[kY] / origin[kW];
    double longest = 0.0;
    x = 1.0, y = 0.0;
    for (const double *p = net.points + 4, *end = net.points + net.size(); p != end; p += 4) {
      const double dx = p[kX] / p[kW] - ox, dy = p[kY] / p[kW] - oy, length = dx * dx + dy * dy;
      if (length > longest) longest = length, x = -dy, y = dx;
    }
    if (longest > 0.0) x /= std::sqrt(longest), y /= std::sqrt(longest);
    for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
      const double offset = (x * p[kX] + y * p[kY]) / p[kW];
      offset_lo = std::min(offset_lo, offset), offset_hi = std::max(offset_hi, offset);
    }
  }
  double width() const { return offset_hi - offset_lo; }
  bool holds(double at_x, double at_y, double room) const {
    const double offset = x * at_x + y * at_y;
    return offset >= offset_lo - room && offset <= offset_hi + room;
  }
};

// How long the net's lines of control points are along one parameter as seen from (x, y), times their weights.
double length_along(const Net& net, bool along_a, double x, double y, double depth_scale) {
  const int lines = along_a ? net.m : net.n, steps = along_a ? net.n : net.m;
  double longest = 0.0;
  for (int line = 0; line <= lines; ++line) {
    double length = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double* p = along_a ? net.at(k, line) : net.at(line, k);
      const double* q = along_a ? net.at(k + 1, line) : net.at(line, k + 1);
      const double w = q[kW] - p[kW];
      length += std::fabs(q[kX] - p[kX] - x * w) + std::fabs(q[kY] - p[kY] - y * w) + depth_scale * std::fabs(w);
    }
    longest = std::max(longest, length);
  }
  return longest;
}

}  // namespace

void Clipper::trace(const RayPatch& patch, const RayRect& rect, HitSink& sink) {
  trace_part(patch, patch.net, {0.0, 1.0, 0.0, 1.0}, rect, sink);
}

void Clipper::trace_part(const RayPatch& patch, const Net& net, const PatchBox& box, const RayRect& rect,
                         HitSink& sink) {
  patch_ = &patch;
  sink_ = &sink;
  nodes_ = 0;
  visit({net, box, patch.region}, rect, 0);
}

// Storage for the net under work (0) and a half that waits (1) at a depth of the recursion.
double* Clipper::stored(int depth, int which) {
  if (stack_.size() < kMaxDepth + 2) stack_.resize(kMaxDepth + 2);
  std::vector<double>& nets = stack_[depth];
  const std::size_t size = patch_->net.size();
  if (nets.size() < 3 * size) nets.resize(3 * size);
  return nets.data() + which * size;
}

void Clipper::visit(Part part, RayRect rect, int depth) {
  const double rounding = kRounding * patch_->magnitude;
  for (;;) {
    if (++nodes_ > kMaxNodes) {
      ++unresolved_;
      return;
    }
    const ScreenHull hull(part.net, *patch_);
    if (hull.behind()) return;
    std::optional<Uniqueness> certificate;
    double negligible = kNegligible;
    if (!hull.crosses_eye_plane()) {
      const double room = rounding / hull.w.lo;
      rect.clip(grid_, {hull.x.lo - room, hull.x.hi + room}, {hull.y.lo - room, hull.y.hi + room});
      if (rect.empty() || sink_->hidden(hull.nearest)) return;
      negligible = std::max(kNegligible, kTooSmall * room);
      if (rect.count() == 1 && std::max(hull.x.width(), hull.y.width()) < negligible) return add_point(part, rect);
      certificate.emplace(part.net);
      const double straight = rect.count() < kRaysWorthClipping ? Uniqueness::kLimit : kStraight;
      if (certificate->q <= straight) return solve(part, rect, *certificate);
    }
    const RayBundle bundle = bundle_of(grid_, rect, kThinnest * rounding);
    Interval a, b;
    if (!clip_net(part.net, bundle, rounding, &a, &b)) return;
    if (a.width() * b.width() <= kWorthClipping) {
      clip(part, a, b, stored(depth, 0));
      continue;
    }
    if (certificate) {
      if (certificate->holds()) return solve(part, rect, *certificate);
      if (visit_single_rays(part, rect, negligible, depth)) return;
    }
    if (depth >= kMaxDepth) {
      unresolved_ += !hull.crosses_eye_plane();  // where the surface passes through the eye nothing is visible
      return;
    }
    if (!outside_region(part)) split(part, rect, depth);
    return;
  }
}

// Drops what of the part no ray meets; `points`: where the new net goes.
void Clipper::clip(Part& part, Interval a, Interval b, double* points) {
  restrict_net(part.net, a.lo, a.hi, b.lo, b.hi, points);
  part.net.points = points;
  const double s = part.box.s1 - part.box.s0, t = part.box.t1 - part.box.t0;
  part.box = {part.box.s0 + a.lo * s, part.box.s0 + a.hi * s, part.box.t0 + b.lo * t, part.box.t0 + b.hi * t};
}

// Whether the part lies outside the trim loops; one certainly inside loses its region.
bool Clipper::outside_region(Part& part) const {
  constexpr double kRoom = 1e-3;
  if (!part.region) return false;
  const Scene::PatchRef& ref = *patch_->patch;
  // Some room, because leaves accept roots beyond their borders.
  const double s = kRoom * (part.box.s1 - part.box.s0), t = kRoom * (part.box.t1 - part.box.t0);
  const Interval u{ref.u.face_from_patch(part.box.s0 - s), ref.u.face_from_patch(part.box.s1 + s)};
  const Interval v{ref.v.face_from_patch(part.box.t0 - t), ref.v.face_from_patch(part.box.t1 + t)};
  if (!part.region->clear(u, v)) return false;
  if (!part.region->contains(u.mid(), v.mid())) return true;
  part.region = nullptr;
  return false;
}

void Clipper::solve(const Part& part, const RayRect& rect, const Uniqueness& certificate) {
  Part inside = part;
  if (outside_region(inside)) return;
  const RayLeaf leaf(*patch_, part.box, part.net, certificate);
  ++leaves_;
  const int columns = rect.i1 - rect.i0;
  const int rows = std::max(1, SolvedRays::kCapacity / columns);
  for (int j = rect.j0; j < rect.j1; j += rows) {
    for (int i = rect.i0; i < rect.i1; i += SolvedRays::kCapacity) {
      const RayRect chunk{i, std::min(i + SolvedRays::kCapacity, rect.i1), j, std::min(j + rows, rect.j1)};
      solve_rays(leaf, grid_, chunk, sink_->farthest(), camera_, solved_);
      unresolved_ += solved_.undecided;
      if (solved_.count) sink_->add(*patch_, inside.region, solved_);
    }
  }
}

// Where few rays pass through the part, each goes on by itself; false if there are too many, or only one already.
bool Clipper::visit_single_rays(const Part& part, const RayRect& rect, double negligible, int depth) {
  const Strip strip(part.net);
  if (strip.width() < negligible) return true;
  if (rect.count() == 1) return false;
  const double room = kRounding * patch_->magnitude;
  int count = 0;
  RayRect few[kFewRays];
  for (int j = rect.j0; j < rect.j1; ++j) {
    for (int i = rect.i0; i < rect.i1; ++i) {
      if (!strip.holds(grid_.x(i), grid_.y(j), room)) continue;
      if (count == kFewRays) return false;
      few[count++] = {i, i + 1, j, j + 1};
    }
  }
  if (count && depth >= kMaxDepth) return false;
  for (int k = 0; k < count; ++k) visit(part, few[k], depth + 1);
  return true;
}

// A part too small to look into any further, as a hit of the ray in its middle.
void Clipper::add_point(const Part& part, const RayRect& ray) {
  Part inside = part;
  if (outside_region(inside)) return;
  const double s = 0.5 * (part.box.s0 + part.box.s1), t = 0.5 * (part.box.t0 + part.box.t1);
  const Jet jet = evaluate(patch_->net, s, t);
  solved_.count = 1;
  solved_.ray[0] = double(ray.j0) * grid_.columns + ray.i0;
  solved_.s[0] = solved_.s_in[0] = s;
  solved_.t[0] = solved_.t_in[0] = t;
  solved_.depth[0] = jet.p[patch_->depth_numerator()] / jet.p[patch_->depth_denominator()];
  for (auto& component : solved_.normal) component[0] = 0.0;
  sink_->add(*patch_, inside.region, solved_);
}

void Clipper::split(const Part& part, const RayRect& rect, int depth) {
  const RayBundle bundle = bundle_of(grid_, rect, 0.0);
  // Across the eye plane the screen says little: there the distance from it counts too, as the weight does.
  const double depth_scale = ScreenHull(part.net, *patch_).crosses_eye_plane() ? grid_.step * grid_.columns : 0.0;
  const bool along_a = length_along(part.net, true, bundle.x, bundle.y, depth_scale) >=
                       length_along(part.net, false, bundle.x, bundle.y, depth_scale);
  double *left = stored(depth, 1), *right = stored(depth, 2);
  Part first = part, second = part;
  split_net(part.net.points, part.net.n, part.net.m, 4, along_a, 0.5, left, right);
  if (along_a) {
    first.box.s1 = second.box.s0 = 0.5 * (part.box.s0 + part.box.s1);
  } else {
    first.box.t1 = second.box.t0 = 0.5 * (part.box.t0 + part.box.t1);
  }
  first.net.points = left, second.net.points = right;
  visit(first, rect, depth + 1);
  visit(second, rect, depth + 1);
}

}  // namespace nofacet
