#include "raster/edge_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bezier/bernstein.h"
#include "parallel.h"
#include "raster/sections.h"
#include "trim/curve.h"

namespace nofacet {
namespace {

constexpr double kFlatness = 0.05;  // pixels between the line and its chords
constexpr double kHalfWidth = 0.6;  // pixels
constexpr double kOpacity = 0.85;
constexpr float kLineColor = 0.01f;  // linear, all three channels
constexpr int kMaxHalvings = 12;
constexpr int kLineRows = 16;

struct LinePoint {
  double x, y, depth;
  bool in_front;
};

struct Chord {
  LinePoint from, to;
};

// Evaluates points of one placed face at its own (u, v).
class FacePoints {
 public:
  FacePoints(const Scene& scene, const Camera& camera, int32_t face) : scene_(scene), camera_(camera) {
    const int32_t definition = scene.model.face_definition[face];
    first_ = last_ = scene.patch_offsets[definition];
    end_ = scene.patch_offsets[definition + 1];
    placement_ = scene.model.placements + 16 * std::size_t(scene.model.face_placement[face]);
  }
  bool empty() const { return first_ == end_; }
  const Camera& camera() const { return camera_; }

  LinePoint at(double u, double v) {
    const Scene::PatchRef& patch = find(u, v);
    const PatchGroup& group = scene_.model.groups[patch.group];
    const int n = group.degree_u, m = group.degree_v;
    const double* p = group.control_points + 4 * std::size_t(n + 1) * (m + 1) * patch.index;
    double bu[kMaxDegree + 1], bv[kMaxDegree + 1], local[4] = {0, 0, 0, 0}, world[4], screen[4];
    bernstein_basis(n, patch.u.patch_from_face(u), bu);
    bernstein_basis(m, patch.v.patch_from_face(v), bv);
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= m; ++j, p += 4) {
        for (int c = 0; c < 4; ++c) local[c] += bu[i] * bv[j] * p[c];
      }
    }
    for (int r = 0; r < 3; ++r) world[r] = Camera::dot(placement_ + 4 * r, local) + placement_[4 * r + 3] * local[3];
    world[3] = local[3];
    camera_.project(world, screen);
    return {screen[0] / screen[2], screen[1] / screen[2], camera_.depth(screen), screen[2] > 0};
  }

  // The point of a curve in (u, v) at t.
  LinePoint on(const double* curve, int degree, double t) {
    const CurvePoint c = evaluate_curve(curve, degree, t);
    return at(c.u, c.v);
  }

 private:
  static double outside(const ParameterMap& map, double u) { return std::max(std::max(map.u0 - u, u - map.u1), 0.0); }

  // The patch that holds (u, v), or the nearest one: loops may overhang their patches by rounding.
  const Scene::PatchRef& find(double u, double v) {
    double best = INFINITY;
    std::size_t found = last_;
    for (std::size_t k = last_, step = 0; step < end_ - first_; ++step, k = k + 1 == end_ ? first_ : k + 1) {
      const double d = outside(scene_.patches[k].u, u) + outside(scene_.patches[k].v, v);
      if (d < best) best = d, found = k;
      if (best == 0.0) break;
    }
    last_ = found;
    return scene_.patches[found];
  }

  const Scene& scene_;
  const Camera& camera_;
  std::size_t first_, end_, last_;
  const double* placement_;
};

bool near_image(const LinePoint& p, const LinePoint& q, const Frame& frame) {
  return std::max(p.x, q.x) >= -1 && std::min(p.x, q.x) <= frame.width + 1 && std::max(p.y, q.y) >= -1 &&
         std::min(p.y, q.y) <= frame.height + 1;
}

// Halves the line from t0 to t1 until what is left is straight: three points of it are near the chord, as a symmetric S
// meets its chord in the middle.
void flatten(FacePoints& points, const double* curve, int degree, const Frame& frame, double t0, const LinePoint& p0,
             const LinePoint& middle, double t1, const LinePoint& p1, int halvings, std::vector<Chord>& out) {
  const LinePoint early = points.on(curve, degree, 0.75 * t0 + 0.25 * t1);
  const LinePoint late = points.on(curve, degree, 0.25 * t0 + 0.75 * t1);
  const auto is_near = [&](const LinePoint& p, double part) {
    const auto away = [&](double LinePoint::* c) { return p.*c - ((1.0 - part) * p0.*c + part * p1.*c); };
    const double depth = away(&LinePoint::depth) * points.camera().pixels_at(p.depth);
    return std::hypot(away(&LinePoint::x), away(&LinePoint::y), depth) <= kFlatness;
  };
  const bool in_front = p0.in_front && p1.in_front;
  const bool straight = in_front && is_near(middle, 0.5) && is_near(early, 0.25) && is_near(late, 0.75);
  if (straight || halvings >= kMaxHalvings) {
    if (in_front && near_image(p0, p1, frame)) out.push_back({p0, p1});
    return;
  }
  const double t = 0.5 * (t0 + t1);
  flatten(points, curve, degree, frame, t0, p0, early, t, middle, halvings + 1, out);
  flatten(points, curve, degree, frame, t, middle, late, t1, p1, halvings + 1, out);
}

std::vector<Chord> face_chords(const Scene& scene, const Camera& camera, const Frame& frame, int32_t face) {
  std::vector<Chord> chords;
  FacePoints points(scene, camera, face);
  if (points.empty()) return chords;
  const Model& model = scene.model;
  const int32_t d = model.face_definition[face];
  const int64_t first = model.loop_offsets[model.definition_loops[d]];
  const int64_t last = model.loop_offsets[model.definition_loops[d + 1]];
  for (int64_t k = first; k < last; ++k) {
    if (model.segment_edge[k] < 0) continue;
    const double* curve = model.segment_points + 3 * model.segment_offsets[k];
    const int degree = int(model.segment_offsets[k + 1] - model.segment_offsets[k]) - 1;
    const LinePoint from = points.on(curve, degree, 0.0), middle = points.on(curve, degree, 0.5),
                    to = points.on(curve, degree, 1.0);
    flatten(points, curve, degree, frame, 0.0, from, middle, 1.0, to, 0, chords);
  }
  return chords;
}

// Leaves of the chords what the section planes keep.
void cut_chords(const Sections& sections, const Camera& camera, std::vector<Chord>& chords) {
  const auto key = [&](double depth) { return camera.perspective ? -1.0 / depth : depth; };
  std::erase_if(chords, [&](Chord& chord) {
    const LinePoint p = chord.from, q = chord.to;
    const double from[3] = {p.x, p.y, key(p.depth)}, to[3] = {q.x, q.y, key(q.depth)};
    const Interval part = sections.kept_part(from, to);
    const auto at = [&](double t) {
      return LinePoint{p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.depth + t * (q.depth - p.depth), true};
    };
    if (part.lo > 0.0) chord.from = at(part.lo);
    if (part.hi < 1.0) chord.to = at(part.hi);
    return part.lo >= part.hi;
  });
}

// How much the depth of the surface at a pixel changes towards its neighbours. A step to another surface on one side
// does not count: the smoother side decides.
double depth_slope(const Frame& frame, int x, int y) {
  const double* depth = frame.depth + std::size_t(y) * frame.width + x;
  auto step = [&](bool before, bool after, std::ptrdiff_t stride) {
    const double p = before ? std::fabs(depth[-stride] - *depth) : INFINITY;
    const double q = after ? std::fabs(depth[stride] - *depth) : INFINITY;
    return std::min(p, q);
  };
  return step(x > 0, x + 1 < frame.width, 1) + step(y > 0, y + 1 < frame.height, frame.width);
}

// Whether a line at this depth is seen at a pixel: it is before the surface there, or lies on it or on the surface of a
// neighbour, within what these fall away inside a pixel. `flatness`: how far the chord may lie off its surface.
bool shows(const Frame& frame, int x, int y, double line, double flatness) {
  const auto slack = [&](int px, int py) { return 1.5 * depth_slope(frame, px, py) + flatness; };
  const auto surface = [&](int px, int py) { return frame.depth[std::size_t(py) * frame.width + px]; };
  if (std::isinf(surface(x, y)) || line <= surface(x, y) + slack(x, y)) return true;
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int px = x + dx, py = y + dy;
    if (px < 0 || py < 0 || px >= frame.width || py >= frame.height || std::isinf(surface(px, py))) continue;
    if (std::fabs(line - surface(px, py)) <= slack(px, py)) return true;
  }
  return false;
}

void draw_chord(const Chord& chord, const Camera& camera, const Frame& frame, int row0, int row1, float* opacity) {
  const LinePoint &p = chord.from, &q = chord.to;
  const double dx = q.x - p.x, dy = q.y - p.y, length2 = dx * dx + dy * dy, reach = kHalfWidth + 0.5;
  const int y0 = std::max(row0, int(std::floor(std::min(p.y, q.y) - reach)));
  const int y1 = std::min(row1 - 1, int(std::ceil(std::max(p.y, q.y) + reach)));
  const Interval box{std::max(-2.0, std::min(p.x, q.x) - reach),
                     std::min(frame.width + 2.0, std::max(p.x, q.x) + reach)};
  const double per_length2 = std::isnormal(length2) ? 1.0 / length2 : 0.0;
  const double half_width = reach * std::sqrt(length2) / std::fabs(dy);  // of the line along a row; infinite if level
  for (int y = y0; y <= y1; ++y) {
    const double ry = y + 0.5 - p.y, middle = p.x + ry * dx / dy;
    const Interval row = half_width < box.width() ? intersect(box, {middle - half_width, middle + half_width}) : box;
    const int x0 = std::max(0, int(std::floor(row.lo)) - 1), x1 = std::min(frame.width - 1, int(std::ceil(row.hi)));
    for (int x = x0; x <= x1; ++x) {
      const double rx = x + 0.5 - p.x;
      const double t = std::clamp((rx * dx + ry * dy) * per_length2, 0.0, 1.0);
      const double away_x = rx - t * dx, away_y = ry - t * dy;
      const double distance = std::sqrt(away_x * away_x + away_y * away_y);
      const float strength = float(kOpacity * std::clamp(reach - distance, 0.0, 1.0));
      float& pixel = opacity[std::size_t(y - row0) * frame.width + x];
      if (strength <= pixel) continue;
      const double line = p.depth + t * (q.depth - p.depth);
      if (shows(frame, x, y, line, 2.0 * kFlatness / camera.pixels_at(line))) pixel = strength;
    }
  }
}

}  // namespace

void draw_edge_lines(const Scene& scene, const Camera& camera, int threads, const Frame& frame,
                     const Sections* sections) {
  std::vector<std::vector<Chord>> chords(scene.model.face_count);
  parallel_for(chords.size(), threads, [&](std::size_t face, int) {
    chords[face] = face_chords(scene, camera, frame, int32_t(face));
    if (sections) cut_chords(*sections, camera, chords[face]);
  });
  const int bands = (frame.height + kLineRows - 1) / kLineRows;
  std::vector<std::vector<const Chord*>> by_band(bands);
  for (const auto& list : chords) {
    for (const Chord& chord : list) {
      const double lo = std::min(chord.from.y, chord.to.y) - 2, hi = std::max(chord.from.y, chord.to.y) + 2;
      const int first = std::clamp(int(std::max(lo, 0.0)) / kLineRows, 0, bands - 1);
      const int last = std::clamp(int(std::min(std::max(hi, 0.0), double(frame.height))) / kLineRows, 0, bands - 1);
      for (int band = first; band <= last; ++band) by_band[band].push_back(&chord);
    }
  }
  parallel_for(by_band.size(), threads, [&](std::size_t band, int) {
    const int row0 = int(band) * kLineRows, row1 = std::min(frame.height, row0 + kLineRows);
    std::vector<float> opacity(std::size_t(row1 - row0) * frame.width, 0.0f);
    for (const Chord* chord : by_band[band]) draw_chord(*chord, camera, frame, row0, row1, opacity.data());
    float* color = frame.color + 4 * std::size_t(row0) * frame.width;
    for (std::size_t k = 0; k < opacity.size(); ++k) {
      const float a = opacity[k];
      if (a == 0.0f) continue;
      for (int c = 0; c < 3; ++c) color[4 * k + c] = color[4 * k + c] * (1.0f - a) + kLineColor * a;
      color[4 * k + 3] = color[4 * k + 3] * (1.0f - a) + a;
    }
  });
}

}  // namespace nofacet
