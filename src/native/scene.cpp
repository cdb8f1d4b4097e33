#include "scene.h"

#include <thread>
#include <utility>

#include "parallel.h"

namespace nofacet {
namespace {

constexpr std::size_t kFewDefinitions = 64;  // are prepared before a second thread has started

}  // namespace

Scene::Scene(Model m) : model(std::move(m)) {
  regions.resize(model.definition_count);
  const int threads = model.definition_count < kFewDefinitions ? 1 : int(std::thread::hardware_concurrency());
  parallel_for(model.definition_count, threads, [&](std::size_t d, int) {
    if (model.trimmed[d]) regions[d] = std::make_unique<Region>(model, d);
  });
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

}  // namespace nofacet
