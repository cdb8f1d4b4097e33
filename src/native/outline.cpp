#include "outline.h"

#include <algorithm>

#include "raster/frame_patches.h"
#include "raster/scan_line.h"

namespace nofacet {

Outline outline(const Scene& scene, const Camera& camera) {
  const ScanPlanes planes(camera.height, 0, true);
  std::vector<double> y;
  for (int row = 0; row < camera.height; ++row) y.push_back(planes.centre_y(row));
  FramePatches patches(scene, camera, planes, 1);
  SpanMaker maker;
  std::vector<Span> spans;
  std::vector<std::vector<Interval>> rows(camera.height);
  for (std::size_t k = 0; k < patches.patches().size(); ++k) {
    const int32_t index = int32_t(k);
    const auto all = [](const HullBounds&) { return true; };
    patches.visit({&index, 1}, 0, all, [&](const Piece& piece) {
      const auto first = std::lower_bound(y.begin(), y.end(), piece.hull.y.lo);
      const auto last = std::upper_bound(first, y.end(), piece.hull.y.hi);
      spans.clear();
      maker.append(piece, y.data() + (first - y.begin()), int(last - first), int(first - y.begin()), camera.width,
                   spans);
      for (const Span& span : spans) {
        rows[span.plane].push_back({std::max(span.x0, 0.0), std::min(span.x1, double(camera.width))});
      }
    });
  }
  Outline result;
  result.offsets.push_back(0);
  for (std::vector<Interval>& stretches : rows) {
    merge_stretches(stretches);
    for (const Interval& stretch : stretches) result.ends.insert(result.ends.end(), {stretch.lo, stretch.hi});
    result.offsets.push_back(int64_t(result.ends.size() / 2));
  }
  return result;
}

}  // namespace nofacet
