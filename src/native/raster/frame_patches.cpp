#include "raster/frame_patches.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "parallel.h"
#include "placed_patch.h"
#include "raster/sections.h"

namespace nofacet {
namespace {

constexpr std::size_t kTaskPatches = 64;  // patches handed to a thread at a time

// Bounds of the patch from its projected control points; false if it is off the screen, or behind the eye.
bool bound_patch(const Net& net, const Camera& camera, const ScanPlanes& planes, PlacedPatch* out) {
  if (is_off_screen(net, camera)) return false;
  out->before_eye = true;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) out->before_eye &= p[kW] > 0;
  if (!out->before_eye) {
    out->x = out->y = out->key = {-INFINITY, INFINITY};
    return true;
  }
  out->x = hull_range(net, kX, kW);
  out->y = hull_range(net, kY, kW);
  out->key = hull_range(net, kZ, kW);
  return planes.any_in(out->y.lo, out->y.hi);
}

}  // namespace

std::vector<std::vector<int32_t>> sort_into_bands(const std::vector<PlacedPatch>& patches, int rows) {
  const int bands = (rows + kBandRows - 1) / kBandRows;
  std::vector<std::vector<int32_t>> result(bands);
  const auto band_of = [&](double y) {
    return std::clamp(int(std::clamp(y, -1.0, rows + 1.0)) / kBandRows, 0, bands - 1);
  };
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const int last = band_of(patches[k].y.hi + 1.0);
    for (int band = band_of(patches[k].y.lo - 1.0); band <= last; ++band) result[band].push_back(int32_t(k));
  }
  return result;
}

FramePatches::FramePatches(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads,
                           const Sections* sections) {
  place(scene, camera, planes, threads, sections);
  Interval depth = Interval::empty();
  for (const PlacedPatch& placed : patches_) {
    if (placed.before_eye) depth.include(camera.depth(placed.key.lo)), depth.include(camera.depth(placed.key.hi));
  }
  if (depth.lo <= depth.hi) depth_tie_ = 1e-11 * depth.magnitude() + 1e-10 * depth.width();
  std::stable_sort(patches_.begin(), patches_.end(),
                   [](const PlacedPatch& p, const PlacedPatch& q) { return p.key.lo < q.key.lo; });
  slots_ = std::make_unique<Slot[]>(patches_.size());
  for (int k = 0; k < threads; ++k) workers_.push_back({PieceBuilder(scene, camera, planes), {}, {}, 0, {}});
}

void FramePatches::place(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads,
                         const Sections* sections) {
  std::vector<PlacedPatch> all;
  for (std::size_t face = 0; face < scene.model.face_count; ++face) {
    const int32_t d = scene.model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
      all.push_back({int32_t(face), &scene.patches[k], {}, {}, {}, false, false});
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
    }
  });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (shown[k]) patches_.push_back(all[k]);
  }
}

std::pair<const Piece*, const Piece*> FramePatches::pieces(int32_t index, int thread) {
  Slot& slot = slots_[index];
  int state = slot.state.load(std::memory_order_acquire);
  if (state == kUntouched && slot.state.compare_exchange_strong(state, kInWork, std::memory_order_acquire)) {
    build(index, workers_[thread]);
    slot.state.store(kReady, std::memory_order_release);
  }
  while (slot.state.load(std::memory_order_acquire) != kReady) std::this_thread::yield();
  return {slot.pieces, slot.pieces + slot.count};
}

void FramePatches::build(int32_t index, Worker& worker) {
  const int64_t before = worker.builder.unresolved();
  worker.found.clear();
  worker.builder.add_patch(patches_[index].face, *patches_[index].patch, worker.found);
  Piece* kept = worker.arena.take(worker.found.size());
  std::copy(worker.found.begin(), worker.found.end(), kept);
  slots_[index].pieces = kept;
  slots_[index].count = int32_t(worker.found.size());
  worker.count += int64_t(worker.found.size());
  if (worker.builder.unresolved() != before) worker.unresolved_faces.push_back(patches_[index].face);
}

int64_t FramePatches::piece_count() const {
  int64_t sum = 0;
  for (const Worker& worker : workers_) sum += worker.count;
  return sum;
}

int64_t FramePatches::unresolved() const {
  int64_t sum = 0;
  for (const Worker& worker : workers_) sum += worker.builder.unresolved();
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
