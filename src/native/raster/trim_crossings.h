// Where scan planes cross the trim curves inside a piece.
#pragma once
#include <vector>

#include "raster/cut.h"

namespace nofacet {

struct TrimCrossing {
  int plane, portion;
  CutPoint point;
};

// Crosses the trim portions of pieces with many planes at once. One per thread; holds scratch memory.
class TrimCrosser {
 public:
  // The crossings with the planes y[0] .. y[count - 1], ascending, by plane, then by a; valid until the next call.
  // They are exact but for rounding: Newton's method, in SIMD lanes or, where that fails, bracketed by the portion,
  // until its last step is below kTrimStep of it, which leaves an error of its square.
  const std::vector<TrimCrossing>& cross(const Piece& piece, const double* y, int count);

 private:
  // A portion and the planes [first, last) that cross it.
  struct Crossed {
    int portion, first, last;
    PlaneRoots roots;  // not of straight ones

    void solve(const Piece& piece, const double* y);
    CutPoint point(const Piece& piece, double y, int plane) const;
  };

  std::vector<Crossed> crossed_;  // the first crossed_count_ are the piece's
  std::size_t crossed_count_ = 0;
  std::vector<TrimCrossing> crossings_;
};

}  // namespace nofacet
