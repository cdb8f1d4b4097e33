// Parts of a projected patch: the whole, the halves it is cut into, and so on down to those that are certified and make
// pieces. What a part consists of is found when it is first needed; what stays hidden is never looked into.
#pragma once
#include <atomic>
#include <cstdint>
#include <span>

#include "bezier/jacobian.h"
#include "bezier/net.h"
#include "raster/certificate.h"
#include "raster/hull_bounds.h"
#include "trim/curve.h"

namespace nofacet {

struct Piece;

// What a part is made of as long as it is closed.
struct PartNet {
  Net net;  // no points: a whole patch, still to be projected
  // Forms that go with the net where they are carried along (bezier/jacobian.h); coefficients may be null.
  Grid jacobian, turn, key_jacobian;
  const CarriedForms* scales = nullptr;  // the whole patch's
  double* memory = nullptr;              // block of `size` numbers that holds the net and the forms, if it is their own
  std::size_t size = 0;
  double s0 = 0.0, s1 = 1.0, t0 = 0.0, t1 = 1.0;  // where it lies in the patch
  bool trimmed = false;                           // else it is inside the trim loops as a whole
  std::span<const TrimArc* const> arcs;           // if trimmed: those that may run through it; empty: any of the face's
  // It crosses the eye plane, or its depths differ by so much that nothing is known of where it lies.
  bool distorted = false;
  int depth = 0;     // halvings of the patch, both directions together
  int calmings = 0;  // of them those of parts that were certified
};

struct Part {
  enum State : int { kClosed, kInWork, kOpen };

  HullBounds hull;
  PartNet closed;
  std::atomic<int> state{kClosed};
  std::atomic<bool> used{false};
  // Once it is open: pieces, or smaller parts, the nearest first, or nothing that any scan plane of the frame meets.
  const Piece* pieces = nullptr;
  Part* parts = nullptr;
  int32_t piece_count = 0, part_count = 0;
  int32_t unresolved = 0;  // pieces that resisted certification and were left out

  bool is_leaf() const { return state.load(std::memory_order_acquire) == kOpen && part_count == 0; }
};

}  // namespace nofacet
