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

// `tie`: depths closer than this are one and the same surface, for coincident faces computed from different patches
// differ by rounding only; the face with the lower index is then shown.
//
// Fills `out` with disjoint segments, ascending in x. Where two surfaces pass through each other the crossing is solved
// to 1e-6 px; a second crossing of the same two spans within half a pixel along x may be missed.
void resolve_visibility(std::vector<Span>& spans, const Camera& camera, double tie, std::vector<VisibleSegment>& out);

// Appends the stretches of `span` that none of `segments` hides: how a transparent face lies before opaque ones.
void visible_parts(const Span& span, const std::vector<VisibleSegment>& segments, const Camera& camera, double tie,
                   std::vector<VisibleSegment>& out);

}  // namespace nofacet
