// The patches of one frame: where each lies on the screen, and its pieces, made when a band of rows first needs them.
#pragma once
#include <atomic>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "raster/piece.h"

namespace nofacet {

// A patch of a face, where the face stands, with bounds on the screen.
struct PlacedPatch {
  int32_t face;
  const Scene::PatchRef* patch;
  HullBounds hull;
  double order;      // patches are drawn in ascending order of this key
  bool before_eye;   // all of it; else the bounds are infinite
  bool one_band;     // the planes that may meet it are all of one band
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
  // The pieces of patches()[index], made at the first call by whichever thread comes first; they do not depend on it.
  // While another thread makes them, this one works ahead: it makes those of `next`, which it may ask for soon.
  // Those of a patch of one band only are made by that band, without what is `hidden` there (null: nothing is).
  std::pair<const Piece*, const Piece*> pieces(int32_t index, int thread, const HiddenTest* hidden = nullptr,
                                               std::span<const int32_t> next = {});

  // Depths this close are the same surface: far above rounding, far below anything visible.
  double depth_tie() const { return depth_tie_; }
  // Of the patches that were asked for; to be called when no thread is at work.
  int64_t piece_count() const;
  int64_t unresolved() const;
  std::vector<int32_t> unresolved_faces() const;

 private:
  enum State : int { kUntouched, kInWork, kReady };
  struct Slot {
    std::atomic<int> state{kUntouched};
    std::atomic<bool> used{false};
    int32_t count = 0;
    int64_t unresolved = 0;
    const Piece* pieces = nullptr;
  };
  // One thread's builder and the memory of what it built.
  struct Worker {
    PieceBuilder builder;
    Arena<Piece> arena;
    std::vector<Piece> found;
  };

  void place(const Scene& scene, const Camera& camera, const ScanPlanes& planes, int threads, const Sections* sections);
  void sort();
  bool build(int32_t index, Worker& worker, const HiddenTest* hidden);
  template <class Value>
  int64_t sum_of_used(Value value) const;

  std::vector<PlacedPatch> patches_;
  std::unique_ptr<Slot[]> slots_;
  std::deque<Worker> workers_;
  double depth_tie_ = 0.0;
};

}  // namespace nofacet
