// The curve in which a scan plane cuts a piece, and the spans it covers.
#pragma once
#include <vector>

#include "raster/piece.h"
#include "raster/screen_jet.h"

namespace nofacet {

// A stretch of the cut along which x moves one way only, inside the trim loops: on it every x in [x0, x1] has exactly
// one point of the surface.
struct Span {
  const Piece* piece;
  double y;               // of the scan plane
  double x0, x1;          // pixels, x0 < x1
  double a0, b0, a1, b1;  // the piece's parameters at x0 and x1
  double depth0, depth1;  // at x0 and x1
  double nearest;         // lower bound of the depth along the span
};

// A point of a surface at a given place on the screen.
struct SurfaceSample {
  double a, b;
  Jet jet;
};

// Appends the spans of `piece` on the scan plane `y` that overlap 0 <= x <= camera.width.
void append_spans(const Piece& piece, double y, const Camera& camera, std::vector<Span>& out);

// The dependent parameter on the cut at a, where the cut must exist; NaN for no guess.
double cut_at(const Piece& piece, double y, double a, double guess);

// The span's surface point at pixel position (x, y'), where y' is within a few nanopixels of the span's plane and x of
// its range. Newton from (sample->a, sample->b); where that strays, bisection on the cut, which cannot fail.
void solve_sample(const Span& span, double x, double y, SurfaceSample* sample);

// Depth of the span at x, and the parameter a there.
double depth_at(const Span& span, double x, const Camera& camera, double* a);

}  // namespace nofacet
