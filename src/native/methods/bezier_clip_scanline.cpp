// bezier_clip_scanline: Nishita, Kaneda, Nakamae, "A scanline algorithm for displaying trimmed surfaces by using Bezier
// clipping", The Visual Computer 7 (1991).
//
// Idea: the scan plane y = const cuts a patch in the curve d(u, v) = Y - y W = 0; follow that curve between its exact
// crossings with patch borders, trim curves and silhouettes, and let spans, not points, compete for visibility.
// Departures from the paper: patches are projected and subdivided once a frame, not once a scanline, and until a piece
// is certified (raster/piece.h), not until it is flat; so spans carry exact points instead of linear interpolation.
// Limits: raster/scan_line.h (double crossings inside half a pixel), kNegligiblePixels (raster/certificate.h).
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "methods.h"
#include "parallel.h"
#include "raster/band.h"
#include "raster/edge_lines.h"
#include "raster/frame_patches.h"
#include "raster/sections.h"
#include "stopwatch.h"

namespace nofacet {
RenderStats render_bezier_clip_scanline(const Scene& scene, const Camera& camera, const RenderOptions& options,
                                        const Frame& frame) {
  RenderStats stats;
  Stopwatch watch;
  const bool area = frame.color || frame.coverage;
  const ScanPlanes planes(frame.height, area ? options.samples : 0, frame.needs_values() || frame.color);
  std::optional<Sections> sections;
  if (!options.sections.empty()) sections.emplace(scene, camera, planes, options.sections, options.threads);
  FramePatches patches(scene, camera, planes, options.threads, sections ? &*sections : nullptr);
  const auto bands = sort_into_bands(patches.patches(), planes);
  watch.lap(stats.project_seconds);

  std::deque<BandPainter> painters;
  for (int k = 0; k < options.threads; ++k) {
    painters.emplace_back(scene, camera, planes, patches, sections ? &*sections : nullptr, k, frame);
  }
  const auto paint = [&](std::size_t band, int thread) {
    const int first = int(band) * planes.band_rows();
    painters[thread].paint(first, std::min(frame.height, first + planes.band_rows()), bands[band]);
  };
  parallel_for(bands.size(), options.threads, paint, options.cancel);
  stats.pieces = patches.piece_count();
  stats.unresolved = patches.unresolved();
  stats.unresolved_faces = patches.unresolved_faces();
  if (sections) sections->add_to(stats);
  for (const BandPainter& painter : painters) {
    stats.subdivide_seconds += painter.times().subdivide;
    stats.span_seconds += painter.times().spans;
    stats.visibility_seconds += painter.times().visibility;
    stats.shade_seconds += painter.times().shade;
    stats.average_seconds += painter.times().average;
  }

  if (options.edges && frame.color && frame.depth && !options.cancelled()) {
    watch.restart();
    draw_edge_lines(scene, camera, options.threads, frame, sections ? &*sections : nullptr);
    watch.lap(stats.edge_seconds);
  }
  return stats;
}

}  // namespace nofacet
