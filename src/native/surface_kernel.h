// Points, normals and curvatures of one placed patch, a point in each SIMD lane.
#pragma once
#include <cstddef>

#include "bezier/net.h"

namespace nofacet {

inline constexpr std::size_t kRunPadding = 16;  // no instruction set has more doubles in a register

// Many points of a patch, and where the results go (surface_point.h), one behind the other.
struct SurfaceRun {
  Net net;                  // wx, wy, wz, w, in the definition's own coordinates
  const double* placement;  // (4, 4), world from these
  double outward;           // +1 or -1: the sense of the normal against Sa x Sb

  // A derivative whose square is no longer than this has vanished.
  double vanished_a, vanished_b;
  // What rounding may do to the curvature along a and b, times the squared length of the derivative.
  double rounding_a, rounding_b;
  // Curvatures of which rounding may have changed more than `known` are NaN; flatter than `flat` counts as that.
  double known, flat;

  const double *a, *b;  // patch parameters, padded to kRunPadding with any others
  std::size_t count;
  double *position, *normal, *curvature, *direction;
  unsigned char* degenerate;  // (count,): 1 where the tangents span no plane; only the position is right there
};

void evaluate_run(const SurfaceRun& run);

}  // namespace nofacet
