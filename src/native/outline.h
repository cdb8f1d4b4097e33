// What of each pixel row the model covers: the exact outline, to compare drawn outlines with.
#pragma once
#include <cstdint>
#include <vector>

#include "camera.h"
#include "scene.h"

namespace nofacet {

// Covered stretches on the planes through the rows' pixel centres, in pixels: disjoint, ascending, inside the picture.
// Those of row r begin and end at ends[2 k] and ends[2 k + 1], k from offsets[r] to offsets[r + 1] - 1.
struct Outline {
  std::vector<int64_t> offsets;
  std::vector<double> ends;
};

Outline outline(const Scene& scene, const Camera& camera);

}  // namespace nofacet
