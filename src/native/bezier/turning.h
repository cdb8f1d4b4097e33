// Where a rational Bezier curve turns in one coordinate.
#pragma once
#include "bezier/bernstein.h"

namespace nofacet {

// Bernstein coefficients of f' w - f w', whose roots are where the coordinate f / w of a curve turns; returns their
// degree, 2 degree - 1, or degree - 1 if all weights are the same. The curve's points lie `stride` values apart, with
// f and w at the given places.
int turning_polynomial(const double* points, std::size_t stride, int f, int w, int degree, double* out);

}  // namespace nofacet
