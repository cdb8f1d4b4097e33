#include "outline.h"

#include <algorithm>
#include <cmath>

#include "raster/piece.h"
#include "raster/span.h"

namespace nofacet {
namespace {

// Appends the disjoint stretches that these cover together; neighbouring faces meet but for rounding.
void append_union(std::vector<Interval>& stretches, std::vector<double>& ends) {
  std::sort(stretches.begin(), stretches.end(), [](const Interval& p, const Interval& q) { return p.lo < q.lo; });
  const std::size_t before = ends.size();
  for (const Interval& next : stretches) {
    if (ends.size() > before && next.lo <= ends.back() + kSliverPixels) {
      ends.back() = std::max(ends.back(), next.hi);
    } else {
      ends.insert(ends.end(), {next.lo, next.hi});
    }
  }
}

}  // namespace

Outline outline(const Scene& scene, const Camera& camera) {
  const ScanPlanes planes(camera.height, 0, true);
  PieceBuilder builder(scene, camera, planes);
  std::vector<double> plane_y(camera.height);
  for (int row = 0; row < camera.height; ++row) plane_y[row] = planes.centre_y(row);
  std::vector<std::vector<Interval>> rows(camera.height);
  SpanMaker maker;
  std::vector<Piece> pieces;
  std::vector<Span> spans;
  for (std::size_t face = 0; face < scene.model.face_count; ++face) {
    const int32_t d = scene.model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
      pieces.clear();
      builder.add_patch(int32_t(face), scene.patches[k], pieces);
      spans.clear();
      for (const Piece& piece : pieces) {
        const auto first = std::lower_bound(plane_y.begin(), plane_y.end(), piece.y.lo);
        const auto last = std::upper_bound(first, plane_y.end(), piece.y.hi);
        const int row = int(first - plane_y.begin());
        if (first < last) maker.append(piece, &*first, int(last - first), row, camera.width, spans);
      }
      for (const Span& span : spans) {
        rows[span.plane].push_back({std::max(span.x0, 0.0), std::min(span.x1, double(camera.width))});
      }
    }
  }
  Outline result;
  result.offsets.push_back(0);
  for (std::vector<Interval>& row : rows) {
    append_union(row, result.ends);
    result.offsets.push_back(int64_t(result.ends.size() / 2));
  }
  return result;
}

}  // namespace nofacet
