// B-splines to Bezier pieces by blossoming (Ramshaw 1989); src/nofacet/cad/bspline.py says how it is used.
#pragma once
#include <cstddef>

namespace nofacet {

// Bezier points of `count` polynomial pieces of one degree over [start, stop], in place. All arrays hold one column for
// each piece. points: (components, degree + 1, count), the control points of each piece's span; knots: (2 degree,
// count), t_{k - degree + 1} .. t_{k + degree} around the span; start, stop: (count,).
void blossom(double* points, std::size_t components, int degree, std::size_t count, const double* knots,
             const double* start, const double* stop);

}  // namespace nofacet
