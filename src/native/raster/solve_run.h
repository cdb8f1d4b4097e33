// Many neighbouring points of one surface at once: Newton's method with a pixel in each SIMD lane.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// A run of pixels on one span, as structure of arrays. In: count, x, a, b (first guesses). Out: a, b, the jets there
// and the size of the last Newton step; a lane has converged if that is below the caller's tolerance.
struct PixelRun {
  static constexpr int kCapacity = 32;

  int count = 0;
  alignas(64) double x[kCapacity];
  alignas(64) double a[kCapacity], b[kCapacity];
  alignas(64) double p[4][kCapacity], pa[4][kCapacity], pb[4][kCapacity];
  alignas(64) double step[kCapacity];
};

// Where a Newton iteration may go.
struct ParameterBox {
  double a_lo, a_hi, b_lo, b_hi;
};

// Newton's method for (x, y)(a, b) = (run.x, y), at most `iterations` evaluations a lane, until every lane's step is
// below `tolerance`. The last step is applied to the point by its tangents (an error of the step squared).
void solve_run(const Net& net, double y, const ParameterBox& box, double tolerance, int iterations, PixelRun& run);

}  // namespace nofacet
