// Surface normal and shading of a visible point.
#pragma once
#include "bezier/net.h"
#include "camera.h"
#include "raster/span.h"

namespace nofacet {

// A piece so small a part of its patch that it has lost the digits that its derivatives are made of.
bool is_tiny(const Piece& piece);

// Unit normal in eye space (right, up, forward), turned towards the eye. Where the surface has no normal (a pole, a
// cone's tip), the limit from inside the patch.
void surface_normal(const Scene& scene, const Piece& piece, const Camera& camera, const SurfaceSample& sample,
                    double normal[3]);

// Linear RGB of a face colour lit by a light at the eye and a soft sky; both sides are lit alike.
void shade(const Camera& camera, const SurfaceSample& sample, const double normal[3], const float color[4],
           float rgb[3]);

}  // namespace nofacet
