// Surface normal and shading of a visible point.
#pragma once
#include "bezier/net.h"
#include "camera.h"
#include "raster/span.h"

namespace nofacet {

// A tangent shorter than this part of the other one is taken for degenerate.
inline constexpr double kDegenerate = 1e-6;
// Tangents span no plane if their product is smaller than this part of the product of their lengths.
inline constexpr double kFlat = 1e-9;

// The light: one from a little above and to the left of the eye, so that faces tilted either way differ; one from the
// eye; a sky, brighter above; and a highlight.
inline constexpr double kKeyLight[3] = {-0.29, 0.35, -0.89};  // direction towards it, in eye space
inline constexpr double kAmbient = 0.10, kSky = 0.17, kFacing = 0.25, kKey = 0.48, kGloss = 0.10;

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
