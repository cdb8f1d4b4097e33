// bezier_clip_scanline: Nishita, Kaneda, Nakamae, "A scanline algorithm for displaying trimmed surfaces by using Bezier
// clipping", The Visual Computer 7 (1991).
//
// Idea: the scan plane y = const cuts a patch in the curve d(u, v) = Y - y W = 0; follow that curve between its exact
// crossings with patch borders, trim curves and silhouettes, and let spans, not points, compete for visibility.
// Departures from the paper: patches are projected and subdivided once a frame, not once a scanline, and until a piece
// is certified (raster/piece.h), not until it is flat; so spans carry exact points instead of linear interpolation.
// Limits: raster/visibility.h (double crossings inside half a pixel), kNegligiblePixels (raster/piece.h).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <numeric>

#include "methods.h"
#include "parallel.h"
#include "raster/band.h"
#include "raster/edge_lines.h"
#include "raster/piece.h"

namespace nofacet {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr int kBandRows = 32;              // rows handed to a thread at a time
constexpr std::size_t kTaskPatches = 16;  // patches handed to a thread at a time

// Projects and subdivides every patch; the pieces come out in the order of faces and patches, whatever the threads.
class Subdivision {
 public:
  Subdivision(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads) {
    struct Task {
      int32_t face;
      std::size_t first, last;
    };
    std::vector<Task> tasks;
    for (std::size_t face = 0; face < scene.model.face_count; ++face) {
      const int32_t d = scene.model.face_definition[face];
      for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; k += kTaskPatches) {
        tasks.push_back({int32_t(face), k, std::min(k + kTaskPatches, scene.patch_offsets[d + 1])});
      }
    }
    builders_.reserve(threads);
    for (int k = 0; k < threads; ++k) builders_.emplace_back(scene, camera, planes);
    std::vector<std::vector<Piece>> found(tasks.size());
    std::vector<uint8_t> incomplete(tasks.size());
    parallel_for(tasks.size(), threads, [&](std::size_t task, int thread) {
      const int64_t before = builders_[thread].unresolved();
      for (std::size_t k = tasks[task].first; k < tasks[task].last; ++k) {
        builders_[thread].add_patch(tasks[task].face, scene.patches[k], found[task]);
      }
      incomplete[task] = builders_[thread].unresolved() != before;
    });
    std::size_t count = 0;
    for (const auto& list : found) count += list.size();
    pieces.reserve(count);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      pieces.insert(pieces.end(), found[k].begin(), found[k].end());
      if (incomplete[k]) unresolved_faces.push_back(tasks[k].face);
    }
    for (const PieceBuilder& builder : builders_) unresolved += builder.unresolved();
  }

  std::vector<Piece> pieces;
  int64_t unresolved = 0;
  std::vector<int32_t> unresolved_faces;

 private:
  std::vector<PieceBuilder> builders_;  // own the pieces' control points
};

// For each band of rows the pieces whose y range meets it.
std::vector<std::vector<const Piece*>> sort_into_bands(const std::vector<Piece>& pieces, int rows) {
  const int bands = (rows + kBandRows - 1) / kBandRows;
  std::vector<std::vector<const Piece*>> result(bands);
  // Nearest first, so that most hidden pieces meet at once what hides them.
  std::vector<const Piece*> order(pieces.size());
  for (std::size_t k = 0; k < pieces.size(); ++k) order[k] = &pieces[k];
  std::stable_sort(order.begin(), order.end(), [](const Piece* p, const Piece* q) { return p->key.lo < q->key.lo; });
  for (const Piece* piece : order) {
    const int first =
        std::clamp(int(std::floor(std::clamp(piece->y.lo, -1.0, rows + 1.0)) - 1) / kBandRows, 0, bands - 1);
    const int last =
        std::clamp(int(std::floor(std::clamp(piece->y.hi, -1.0, rows + 1.0)) + 1) / kBandRows, 0, bands - 1);
    for (int band = first; band <= last; ++band) result[band].push_back(piece);
  }
  return result;
}

// Depths this close are the same surface: far above rounding, far below anything visible.
double tie_tolerance(const std::vector<Piece>& pieces) {
  Interval key = Interval::empty();
  for (const Piece& piece : pieces) key.include(piece.key.lo), key.include(piece.key.hi);
  return pieces.empty() ? 0.0 : 1e-11 * key.magnitude() + 1e-10 * key.width();
}

}  // namespace

RenderStats render_bezier_clip_scanline(const Scene& scene, const Camera& camera, const RenderOptions& options,
                                        const Frame& frame) {
  RenderStats stats;
  auto start = Clock::now();
  const bool area = frame.color || frame.coverage;
  const ScanPlanes planes(frame.height, area ? options.samples : 0, frame.needs_values() || frame.color);
  const Subdivision subdivision(scene, camera, planes, options.threads);
  const auto bands = sort_into_bands(subdivision.pieces, frame.height);
  const double tie = tie_tolerance(subdivision.pieces);
  stats.pieces = int64_t(subdivision.pieces.size());
  stats.unresolved = subdivision.unresolved;
  stats.unresolved_faces = subdivision.unresolved_faces;
  stats.subdivide_seconds = seconds_since(start);

  start = Clock::now();
  std::deque<BandPainter> painters;
  for (int k = 0; k < options.threads; ++k) painters.emplace_back(scene, camera, planes, tie, frame);
  parallel_for(bands.size(), options.threads, [&](std::size_t band, int thread) {
    const int first = int(band) * kBandRows;
    painters[thread].paint(first, std::min(frame.height, first + kBandRows), bands[band]);
  });
  stats.scan_seconds = seconds_since(start);

  if (options.edges && frame.color && frame.depth) {
    start = Clock::now();
    draw_edge_lines(scene, camera, options.threads, frame);
    stats.edge_seconds = seconds_since(start);
  }
  return stats;
}

}  // namespace nofacet
