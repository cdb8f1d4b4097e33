// Newton's method on a part of a trim curve, for many scan planes at once: a plane in each SIMD lane.
#pragma once
#include "raster/cut_kernels.h"
#include "raster/piece.h"

namespace nofacet {

// A last step below this, in units of the portion's range of t, leaves an error of its square.
inline constexpr double kTrimStep = 1e-7;

// Where the portion crosses the planes roots.y[0] .. roots.y[count - 1], which lie between its ends: the point into
// roots.a, b, x and key. roots.step, in units of the portion's range, is not below kTrimStep where that was not found.
void trim_roots(const Piece& piece, const TrimPortion& portion, std::size_t count, PlaneRoots& roots);

}  // namespace nofacet
