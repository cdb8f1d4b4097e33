// The patches of one frame: where each lies on the screen, and its parts down to pieces, found when a band of rows
// first needs them.
#pragma once
#include <algorithm>
#include <atomic>
#include <deque>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "raster/piece.h"
#include "stopwatch.h"

namespace nofacet {

// A patch of a face, where the face stands, with bounds on the screen.
struct PlacedPatch {
  int32_t face;
  const Scene::PatchRef* patch;
  HullBounds hull;
  double order;      // patches are drawn in ascending order of this key
  bool before_eye;   // all of it; else the bounds are infinite
  bool cut = false;  // a section plane may run through it
};

class Sections;

// For each band of rows the patches whose y range meets it.
std::vector<std::vector<int32_t>> sort_into_bands(const std::vector<PlacedPatch>& patches, const ScanPlanes& planes);

class FramePatches {
 public:
  // Projects all patches and keeps those that some scan plane may meet, those first that may hide others; with
  // `sections` (else null) only what these leave.
  FramePatches(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads,
               const Sections* sections = nullptr);

  const std::vector<PlacedPatch>& patches() const { return patches_; }
  // Calls use(piece) for the pieces of patches()[list[0]], but for those of parts that are not needed (of their hulls):
  // these may be left closed. Closed ones are opened by whichever thread comes first; what is in them does not depend
  // on it. While another thread opens one, this one works ahead: it opens parts that it needs of all of the list.
  template <class Needs, class Use>
  void visit(std::span<const int32_t> list, int thread, const Needs& needs, const Use& use) {
    visit(list, wholes_[list[0]], thread, needs, use);
  }
  // That the thread has spent in opening parts.
  double opening_seconds(int thread) const { return workers_[thread].opening_seconds; }

  // Depths this close are the same surface: far above rounding, far below anything visible.
  double depth_tie() const { return depth_tie_; }
  // Of the parts that were visited; to be called when no thread is at work.
  int64_t piece_count() const;
  int64_t unresolved() const;
  std::vector<int32_t> unresolved_faces() const;

 private:
  struct Whole : Part {
    std::atomic<int> opened{0};  // parts of it
  };
  // One thread's builder, and what it was the first to visit.
  struct Worker {
    PieceBuilder builder;
    double opening_seconds = 0.0;
    int64_t pieces = 0, unresolved = 0;
    std::vector<int32_t> unresolved_faces;
  };

  template <class Needs, class Use>
  void visit(std::span<const int32_t> list, Part& part, int thread, const Needs& needs, const Use& use);
  template <class Needs>
  void wait(std::span<const int32_t> list, const Part& part, Worker& worker, const Needs& needs);
  template <class Needs>
  bool open_some(int32_t patch, Part& part, Worker& worker, const Needs& needs);
  bool open(int32_t patch, Part& part, Worker& worker);
  void count(int32_t patch, Part& part, Worker& worker);
  void place(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads, const Sections* sections);
  void sort();

  std::vector<PlacedPatch> patches_;
  std::unique_ptr<Whole[]> wholes_;
  std::deque<Worker> workers_;
  double depth_tie_ = 0.0;
};

template <class Needs, class Use>
void FramePatches::visit(std::span<const int32_t> list, Part& part, int thread, const Needs& needs, const Use& use) {
  Worker& worker = workers_[thread];
  // Pieces are better judged one by one, once a band has needed some of them: what was opened ahead may not be needed.
  if (!part.is_leaf() || !part.used.load(std::memory_order_relaxed)) {
    if (!needs(part.hull)) return;
    if (part.state.load(std::memory_order_acquire) != Part::kOpen) {
      Stopwatch watch;
      if (!open(list[0], part, worker)) wait(list, part, worker, needs);
      watch.lap(worker.opening_seconds);
    }
  }
  if (!part.used.load(std::memory_order_relaxed)) count(list[0], part, worker);
  for (const Piece *piece = part.pieces, *end = piece + part.piece_count; piece != end; ++piece) use(*piece);
  for (Part *inner = part.parts, *end = inner + part.part_count; inner != end; ++inner) {
    visit(list, *inner, thread, needs, use);
  }
}

// Works ahead until the part is open.
template <class Needs>
void FramePatches::wait(std::span<const int32_t> list, const Part& part, Worker& worker, const Needs& needs) {
  while (part.state.load(std::memory_order_acquire) != Part::kOpen) {
    while (!list.empty() && !open_some(list[0], wholes_[list[0]], worker, needs)) list = list.subspan(1);
    if (list.empty()) std::this_thread::yield();
  }
}

// Opens a part that is needed; whether one was found.
template <class Needs>
bool FramePatches::open_some(int32_t patch, Part& part, Worker& worker, const Needs& needs) {
  if (part.is_leaf() || !needs(part.hull)) return false;
  if (part.state.load(std::memory_order_acquire) != Part::kOpen) return open(patch, part, worker);
  return std::any_of(part.parts, part.parts + part.part_count,
                     [&](Part& inner) { return open_some(patch, inner, worker, needs); });
}

}  // namespace nofacet
