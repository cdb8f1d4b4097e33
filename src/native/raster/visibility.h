// Hidden surface removal on one scan plane: which span is nearest, over which stretch of x.
#pragma once
#include <vector>

#include "raster/scan_cut.h"

namespace nofacet {

// A stretch [x0, x1] of the scan plane on which `span` is the nearest surface.
struct VisibleSegment {
  double x0, x1;
  const Span* span;
};

// Depths closer than this (relative to the depth of the frame's model) are one and the same surface: coincident faces
// computed from different patches differ by rounding only. The face with the lower index is then shown.
bool hides(const Span& front, double front_depth, const Span& back, double back_depth, double tie);

// Fills `out` with disjoint segments, ascending in x. Where two surfaces pass through each other the crossing is solved
// to 1e-6 px; a second crossing of the same two spans within half a pixel of a scan plane may be missed.
void resolve_visibility(std::vector<Span>& spans, const Camera& camera, double tie, std::vector<VisibleSegment>& out);

}  // namespace nofacet
