#include "raster/frame_patches.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "placed_patch.h"
#include "raster/sections.h"

namespace nofacet {
namespace {

constexpr std::size_t kTaskPatches = 64;  // patches handed to a thread at a time
constexpr int kMaxParts = 1 << 20;        // opened of one patch; an honest one needs a few hundred

// Bounds of the patch from its projected control points; false if it is off the screen, or behind the eye.
bool bound_patch(const Net& net, const Camera& camera, const ScanPlanes& planes, PlacedPatch* out) {
  if (is_off_screen(net, camera)) return false;
  out->before_eye = true;
  out->order = -INFINITY;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) out->before_eye &= p[kW] > 0;
  if (!out->before_eye) {
    out->hull = kUnbounded;
    return true;
  }
  const ComponentRanges range = ratio_ranges(net);
  const Interval y = range[kY];
  if (!planes.any_in(y.lo, y.hi)) return false;
  out->hull = hull_bounds(net, range[kX], y, range[kZ]);
  out->order = out->hull.key.lo;
  return true;
}

// Whether the patch, before the eye, bounds a closed body and faces away from the eye at its corners.
bool faces_away(const Scene& scene, int32_t face, const Net& net) {
  const int64_t use = scene.face_body_offsets[face];
  if (scene.face_body_offsets[face + 1] != use + 1) return false;
  const double outward = scene.face_bodies[use].outward;
  const auto step = [](const double* p, const double* q, Component c) { return q[c] / q[kW] - p[c] / p[kW]; };
  for (const int i : {0, net.n}) {
    for (const int j : {0, net.m}) {
      const double *p = net.at(i, j), *a = net.at(i == 0 ? 1 : i - 1, j), *b = net.at(i, j == 0 ? 1 : j - 1);
      const double jacobian = step(p, a, kX) * step(p, b, kY) - step(p, b, kX) * step(p, a, kY);
      const double sign = (i == 0) == (j == 0) ? outward : -outward;  // steps back change it
      if (!(sign * jacobian > 0)) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<std::vector<int32_t>> sort_into_bands(const std::vector<PlacedPatch>& patches, const ScanPlanes& planes) {
  std::vector<std::vector<int32_t>> result(planes.bands());
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const int last = planes.band_of(patches[k].hull.y.hi + 1.0);
    for (int band = planes.band_of(patches[k].hull.y.lo - 1.0); band <= last; ++band)
      result[band].push_back(int32_t(k));
  }
  return result;
}

FramePatches::FramePatches(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads,
                           const Sections* sections) {
  place(scene, camera, planes, threads, sections);
  Interval depth = Interval::empty();
  for (const PlacedPatch& placed : patches_) {
    if (placed.before_eye)
      depth.include(camera.depth(placed.hull.key.lo)), depth.include(camera.depth(placed.hull.key.hi));
  }
  if (depth.lo <= depth.hi) depth_tie_ = 1e-11 * depth.magnitude() + 1e-10 * depth.width();
  sort();
  wholes_ = std::make_unique<Whole[]>(patches_.size());
  for (std::size_t k = 0; k < patches_.size(); ++k) wholes_[k].hull = patches_[k].hull;
  for (int k = 0; k < threads; ++k) workers_.push_back({PieceBuilder(scene, camera, planes), 0.0, 0, 0, {}});
}

void FramePatches::place(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads,
                         const Sections* sections) {
  std::vector<PlacedPatch> all;
  for (std::size_t face = 0; face < scene.model.face_count; ++face) {
    const int32_t d = scene.model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
      all.push_back({int32_t(face), &scene.patches[k], {}, 0.0, false, false});
    }
  }
  std::vector<uint8_t> shown(all.size());
  parallel_for((all.size() + kTaskPatches - 1) / kTaskPatches, threads, [&](std::size_t task, int) {
    std::vector<double> points;
    for (std::size_t k = task * kTaskPatches; k < std::min(all.size(), (task + 1) * kTaskPatches); ++k) {
      const Net net = projected_net(scene, camera, all[k].face, *all[k].patch, points);
      const Sections::Side side = sections ? sections->side(net) : Sections::Side::kept;
      all[k].cut = side == Sections::Side::cut;
      shown[k] = side != Sections::Side::removed && bound_patch(net, camera, planes, &all[k]);
      // Its own body hides it, most likely by what is not much nearer: that is to be drawn before.
      if (shown[k] && all[k].before_eye && faces_away(scene, all[k].face, net)) all[k].order = all[k].hull.key.mid();
    }
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (shown[k]) patches_.push_back(all[k]);
  }
}

void FramePatches::sort() {
  std::vector<std::pair<double, int32_t>> order;
  order.reserve(patches_.size());
  for (const PlacedPatch& patch : patches_) order.emplace_back(patch.order, int32_t(order.size()));
  std::sort(order.begin(), order.end());
  std::vector<PlacedPatch> sorted;
  sorted.reserve(patches_.size());
  for (const auto& [key, index] : order) sorted.push_back(patches_[index]);
  patches_.swap(sorted);
}

// Opens a part unless some thread has begun to; whether it did.
bool FramePatches::open(int32_t patch, Part& part, Worker& worker) {
  int state = Part::kClosed;
  if (!part.state.compare_exchange_strong(state, Part::kInWork, std::memory_order_acquire)) return false;
  if (wholes_[patch].opened.fetch_add(1, std::memory_order_relaxed) < kMaxParts) {
    worker.builder.open(patches_[patch].face, *patches_[patch].patch, part);
  } else {
    part.unresolved = 1;
  }
  part.state.store(Part::kOpen, std::memory_order_release);
  return true;
}

// Counts what is in a part that no thread has visited yet.
void FramePatches::count(int32_t patch, Part& part, Worker& worker) {
  if (part.used.exchange(true, std::memory_order_relaxed)) return;
  worker.pieces += part.piece_count;
  worker.unresolved += part.unresolved;
  if (part.unresolved > 0) worker.unresolved_faces.push_back(patches_[patch].face);
}

int64_t FramePatches::piece_count() const {
  int64_t sum = 0;
  for (const Worker& worker : workers_) sum += worker.pieces;
  return sum;
}

int64_t FramePatches::unresolved() const {
  int64_t sum = 0;
  for (const Worker& worker : workers_) sum += worker.unresolved;
  return sum;
}

std::vector<int32_t> FramePatches::unresolved_faces() const {
  std::vector<int32_t> faces;
  for (const Worker& worker : workers_) {
    faces.insert(faces.end(), worker.unresolved_faces.begin(), worker.unresolved_faces.end());
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

}  // namespace nofacet
