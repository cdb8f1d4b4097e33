// Newton's method on the borders and folds of a piece, for many scan planes at once: a plane in each SIMD lane.
#pragma once
#include <vector>

#include "bezier/centred_net.h"

namespace nofacet {

// Results for a run of scan planes, as structure of arrays.
struct PlaneRoots {
  std::vector<double> y;       // in: of the planes
  std::vector<double> a, b;    // the root; for a fold, first the guess
  std::vector<double> x, key;  // there
  std::vector<double> step;    // size of the last Newton step; above kRootStep the root was not found

  // For `count` planes and up to a SIMD vector more, which repeat the last plane.
  void resize(std::size_t count);
  void pad(std::size_t count);
};

// A last step below this leaves an error of its square, in units of the parameter.
inline constexpr double kRootStep = 1e-8;

// Where the curve `points` (degree + 1 homogeneous points, `stride` doubles apart), whose y runs from y0 to y1 one way,
// meets the planes: the parameter into roots.a.
void border_roots(const double* points, std::size_t stride, int degree, std::size_t count, PlaneRoots& roots);

// The screen Jacobian's sign at (roots.a, roots.b), into roots.step: its value times W^3, for the sign only.
void jacobians(const CentredNet& net, std::size_t count, PlaneRoots& roots);

// Where the Jacobian vanishes along the cuts by the planes, from the guesses (roots.a, roots.b).
void fold_roots(const CentredNet& net, std::size_t count, PlaneRoots& roots);

}  // namespace nofacet
