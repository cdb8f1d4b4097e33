// A model prepared for drawing: what does not change from frame to frame.
#pragma once
#include <memory>
#include <vector>

#include "bezier/parameter_map.h"
#include "model.h"
#include "trim/region.h"

namespace nofacet {

struct Scene {
  struct PatchRef {
    int32_t group, index;
    ParameterMap u, v;
  };

  Model model;
  std::vector<std::unique_ptr<Region>> regions;  // per definition; null where the patches are drawn whole
  // Patches of definition d: patches[patch_offsets[d]] .. patches[patch_offsets[d + 1] - 1].
  std::vector<std::size_t> patch_offsets;
  std::vector<PatchRef> patches;

  explicit Scene(Model m);
};

}  // namespace nofacet
