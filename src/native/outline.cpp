#include "outline.h"

#include <algorithm>
#include <cmath>

#include "raster/plane_cut.h"

namespace nofacet {

Outline outline(const Scene& scene, const Camera& camera) {
  const ScanPlanes planes(camera.height, 0, true);
  PieceBuilder builder(scene, camera, planes);
  std::vector<Piece> pieces;
  for (std::size_t face = 0; face < scene.model.face_count; ++face) {
    const int32_t d = scene.model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
      builder.add_patch(int32_t(face), scene.patches[k], pieces);
    }
  }
  std::vector<std::vector<const Piece*>> rows(camera.height);
  for (const Piece& piece : pieces) {
    const int first = std::max(0, int(std::floor(std::max(piece.y.lo, 0.0))) - 1);
    const int last = std::min(camera.height - 1, int(std::ceil(std::min(piece.y.hi, double(camera.height)))));
    for (int row = first; row <= last; ++row) rows[row].push_back(&piece);
  }
  Outline result;
  result.offsets.push_back(0);
  PlaneCut cut;
  for (int row = 0; row < camera.height; ++row) {
    cut.intersect(rows[row], planes.centre_y(row), scene, camera, 0.0);
    for (const Interval& stretch : cut.covered) {
      result.stretches.push_back({std::max(stretch.lo, 0.0), std::min(stretch.hi, double(camera.width))});
    }
    result.offsets.push_back(int64_t(result.stretches.size()));
  }
  return result;
}

}  // namespace nofacet
