#include "ray/ray_scene.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"
#include "placed_patch.h"

namespace nofacet {
namespace {

constexpr std::size_t kTaskPatches = 64;  // patches handed to a thread at a time

// Fills in what the projected net tells. `depth` is widened by the patch's.
void describe(const Camera& camera, RayPatch& patch, Interval& depth) {
  patch.x = patch.y = {-INFINITY, INFINITY};
  patch.nearest = -INFINITY;
  patch.magnitude = 0.0;
  bool in_front = true;
  for (const double *p = patch.net.points, *end = p + patch.net.size(); p != end; p += 4) {
    in_front &= p[kW] > 0;
    patch.magnitude = std::max(patch.magnitude,
                               std::fabs(p[kX]) + std::fabs(p[kY]) + (camera.width + camera.height) * std::fabs(p[kW]));
  }
  const Component numerator = patch.depth_numerator(), denominator = patch.depth_denominator();
  Interval range = Interval::empty();
  for (const double *p = patch.net.points, *end = p + patch.net.size(); p != end; p += 4) {
    range.include(p[numerator] / p[denominator]);
  }
  if (!in_front) range.lo = std::max(range.lo, 0.0);
  depth.include(range.lo), depth.include(range.hi);
  if (!in_front) return;
  patch.nearest = range.lo;
  patch.x = hull_range(patch.net, kX, kW);
  patch.y = hull_range(patch.net, kY, kW);
}

}  // namespace

void project_ray_patch(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch,
                       double* out) {
  project_patch(scene, camera, face, patch, out);
  if (!camera.perspective) return;
  const PatchGroup& group = scene.model.groups[patch.group];
  const std::size_t size = 4 * std::size_t(group.degree_u + 1) * (group.degree_v + 1);
  for (std::size_t k = 0; k < size; k += 4) out[k + kZ] = -out[k + kZ];
}

RayScene::RayScene(const Scene& scene, const Camera& camera, int threads) : scene_(scene), nets_(threads) {
  struct Task {
    int32_t face;
    std::size_t first, last;
  };
  const Model& model = scene.model;
  std::vector<Task> tasks;
  for (std::size_t face = 0; face < model.face_count; ++face) {
    const int32_t d = model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; k += kTaskPatches) {
      tasks.push_back({int32_t(face), k, std::min(k + kTaskPatches, scene.patch_offsets[d + 1])});
    }
  }
  std::vector<std::vector<RayPatch>> found(tasks.size());
  std::vector<Interval> depths(tasks.size(), Interval::empty());
  parallel_for(tasks.size(), threads, [&](std::size_t task, int thread) {
    const int32_t face = tasks[task].face;
    const Region* region = scene.regions[model.face_definition[face]].get();
    for (std::size_t k = tasks[task].first; k < tasks[task].last; ++k) {
      const Scene::PatchRef& ref = scene.patches[k];
      const PatchGroup& group = model.groups[ref.group];
      RayPatch patch{{group.degree_u, group.degree_v, nullptr}, &ref, region, face, camera.perspective, {}, {}, 0, 0};
      double* points = nets_[thread].take(patch.net.size());
      project_ray_patch(scene, camera, face, ref, points);
      patch.net.points = points;
      if (is_off_screen(patch.net, camera)) continue;
      describe(camera, patch, depths[task]);
      found[task].push_back(patch);
    }
  });
  Interval depth = Interval::empty();
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    patches.insert(patches.end(), found[task].begin(), found[task].end());
    if (found[task].empty()) continue;
    depth.include(depths[task].lo), depth.include(depths[task].hi);
    transparent = transparent || lets_light_through(found[task].front());
  }
  if (!patches.empty()) tie = 1e-11 * depth.magnitude() + 1e-10 * depth.width();
}

}  // namespace nofacet
