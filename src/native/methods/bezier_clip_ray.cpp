// bezier_clip_ray: Nishita, Sederberg, Kakimoto, "Ray tracing trimmed rational surface patches", Computer Graphics
// (Proc. SIGGRAPH) 24 (1990).
//
// Idea: a ray is the intersection of two planes; the control points' distances from them make the patch a map to the
// plane in which the ray is the origin, and its roots are found by clipping the patch, in u and in v, to where the
// convex hull of those distances meets zero.
// Departures from the paper: rays are clipped in bundles, a tile's together (the paper: a scanline's), until a
// certificate says that each ray meets what is left once at most (ray/uniqueness.h); then Newton's method ends the
// search, several rays at a time. The trim test counts crossings of a line in (u, v) with the loops, which are kept
// cut into monotone arcs; the paper clips the loops. Either finds the same crossings.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "methods.h"
#include "parallel.h"
#include "raster/edge_lines.h"
#include "ray/part_tree.h"
#include "ray/ray_scene.h"
#include "ray/tile_painter.h"
#include "stopwatch.h"

namespace nofacet {
namespace {

// The tiles of the interval [lo, hi] of pixels, as a first and a last index; no tile if it is empty or off screen.
struct TileRange {
  int first, last;
  TileRange(Interval pixels, int size) {
    constexpr int kTile = TilePainter::kTile;
    // A pixel of room: rays lie off the pixels' centres by a little.
    first = int(std::clamp(pixels.lo - 1.0, 0.0, double(size)) / kTile);
    last = pixels.hi < -1.0 ? -1 : int(std::clamp(pixels.hi + 1.0, 0.0, size - 1.0) / kTile);
  }
};

// For each row of tiles the patches that may be seen in it, from the nearest to the farthest.
std::vector<std::vector<const RayPatch*>> sort_into_bands(const RayScene& rays, int height) {
  std::vector<std::vector<const RayPatch*>> bands((height + TilePainter::kTile - 1) / TilePainter::kTile);
  for (const RayPatch& patch : rays.patches) {
    const TileRange range(patch.y, height);
    for (int band = range.first; band <= range.last; ++band) bands[band].push_back(&patch);
  }
  for (auto& band : bands) {
    std::stable_sort(band.begin(), band.end(),
                     [](const RayPatch* p, const RayPatch* q) { return p->nearest < q->nearest; });
  }
  return bands;
}

void paint_band(TilePainter& painter, const std::vector<const RayPatch*>& patches, int band,
                const RenderOptions& options, const Frame& frame) {
  constexpr int kTile = TilePainter::kTile;
  std::vector<std::vector<const RayPatch*>> tiles((frame.width + kTile - 1) / kTile);
  for (const RayPatch* patch : patches) {
    const TileRange range(patch->x, frame.width);
    for (int tile = range.first; tile <= range.last; ++tile) tiles[tile].push_back(patch);
  }
  for (int tile = 0; tile < int(tiles.size()) && !options.cancelled(); ++tile) {
    painter.paint({tile * kTile, std::min(frame.width, (tile + 1) * kTile), band * kTile,
                   std::min(frame.height, (band + 1) * kTile)},
                  tiles[tile]);
  }
}

}  // namespace

RenderStats render_bezier_clip_ray(const Scene& scene, const Camera& camera, const RenderOptions& options,
                                   const Frame& frame) {
  RenderStats stats;
  Stopwatch watch;
  const RayScene rays(scene, camera, options.threads);
  const auto bands = sort_into_bands(rays, frame.height);
  std::optional<PartTree> tree;
  if (frame.color && (options.shadows || options.reflectance > 0.0)) tree.emplace(scene, camera);
  watch.lap(stats.project_seconds);

  std::vector<std::unique_ptr<TilePainter>> painters;
  for (int k = 0; k < options.threads; ++k) {
    painters.push_back(std::make_unique<TilePainter>(scene, camera, rays, options, tree ? &*tree : nullptr, frame));
  }
  parallel_for(
      bands.size(), options.threads,
      [&](std::size_t band, int thread) { paint_band(*painters[thread], bands[band], int(band), options, frame); },
      options.cancel);
  for (const auto& painter : painters) {
    stats.pieces += painter->clipper().leaves();
    stats.unresolved += painter->clipper().unresolved();
    if (const Clipper* secondary = painter->shader().clipper()) stats.unresolved += secondary->unresolved();
  }
  for (std::size_t face = 0; face < scene.model.face_count && !options.sections.empty(); ++face) {
    const auto cut = [&](const auto& painter) { return painter->sections()->uncapped()[face] != 0; };
    if (std::any_of(painters.begin(), painters.end(), cut)) stats.uncapped_faces.push_back(int32_t(face));
  }
  watch.lap(stats.trace_seconds);

  if (options.edges && frame.color && frame.depth && !options.cancelled()) {
    draw_edge_lines(scene, camera, options.threads, frame);
    watch.lap(stats.edge_seconds);
  }
  return stats;
}

}  // namespace nofacet
