// Where scan planes cross the trim curves inside a piece.
#pragma once
#include <vector>

#include "raster/cut.h"

namespace nofacet {

struct TrimCrossing {
  int plane, portion;
  CutPoint point;
};

// Writes the crossings of the piece's trim portions with the planes y[0] .. y[count - 1], ascending, to `out`: by
// plane, then by a. They are exact but for rounding: Newton's method, bracketed by the portion, until its last step is
// below 1e-7 of it, which leaves an error of its square.
void find_trim_crossings(const Piece& piece, const double* y, int count, std::vector<TrimCrossing>& out);

}  // namespace nofacet
