#include "scene.h"

#include <algorithm>
#include <array>
#include <map>
#include <thread>
#include <utility>

#include "parallel.h"

namespace nofacet {
namespace {

constexpr std::size_t kFewPoints = 2'000;  // of loops are prepared before a second thread has started

// Control points of all loops.
std::size_t loop_points(const Model& model) {
  const int64_t loops = model.definition_loops[model.definition_count];
  return std::size_t(model.segment_offsets[model.loop_offsets[loops]]);
}

}  // namespace

Scene::Scene(Model m) : model(std::move(m)) {
  regions.resize(model.definition_count);
  const int threads = loop_points(model) < kFewPoints ? 1 : int(std::thread::hardware_concurrency());
  parallel_for(model.definition_count, threads, [&](std::size_t d, int) {
    if (model.trimmed[d]) regions[d] = std::make_unique<Region>(model, d);
  });
  prepare_patches();
  prepare_bodies();
}

void Scene::prepare_patches() {
  patch_offsets.assign(model.definition_count + 1, 0);
  for (const PatchGroup& group : model.groups) {
    for (std::size_t k = 0; k < group.count; ++k) ++patch_offsets[group.definition[k] + 1];
  }
  for (std::size_t d = 0; d < model.definition_count; ++d) patch_offsets[d + 1] += patch_offsets[d];
  patches.resize(patch_offsets.back());
  std::vector<std::size_t> next(patch_offsets.begin(), patch_offsets.end() - 1);
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    const PatchGroup& group = model.groups[g];
    for (std::size_t k = 0; k < group.count; ++k) {
      const double* domain = group.domain + 4 * k;
      patches[next[group.definition[k]]++] = {int32_t(g), int32_t(k),
                                              ParameterMap(domain[0], domain[1], group.angular[2 * k]),
                                              ParameterMap(domain[2], domain[3], group.angular[2 * k + 1])};
    }
  }
}

void Scene::prepare_bodies() {
  face_body_offsets.assign(model.face_count + 1, 0);
  const auto for_each_use = [&](auto&& use) {
    for (std::size_t b = 0; b < model.body_count; ++b) {
      for (int64_t k = model.body_offsets[b]; k < model.body_offsets[b + 1]; ++k) use(b, model.body_face[k], k);
    }
  };
  for_each_use([&](std::size_t b, int32_t face, int64_t) { face_body_offsets[face + 1] += model.body_closed[b]; });
  for (std::size_t f = 0; f < model.face_count; ++f) face_body_offsets[f + 1] += face_body_offsets[f];
  face_bodies.resize(face_body_offsets.back());
  std::vector<int64_t> next(face_body_offsets.begin(), face_body_offsets.end() - 1);
  for_each_use([&](std::size_t b, int32_t face, int64_t k) {
    if (model.body_closed[b]) face_bodies[next[face]++] = {int32_t(b), model.body_face_outward[k]};
  });
  body_colors.resize(4 * model.body_count);
  for (std::size_t b = 0; b < model.body_count; ++b) {
    std::map<std::array<float, 4>, int> faces;  // of each colour
    int most = 0;
    for (int64_t k = model.body_offsets[b]; k < model.body_offsets[b + 1]; ++k) {
      std::array<float, 4> color;
      std::copy_n(model.face_color + 4 * std::size_t(model.body_face[k]), 4, color.begin());
      if (++faces[color] <= most) continue;
      most = faces[color];
      std::copy(color.begin(), color.end(), body_colors.begin() + 4 * b);
    }
  }
}

}  // namespace nofacet
