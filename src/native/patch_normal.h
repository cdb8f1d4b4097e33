// Normals from homogeneous derivatives, also where the surface has none of its own: at poles and cones' tips.
#pragma once
#include <cstdint>

#include "bezier/net.h"
#include "camera.h"
#include "scene.h"

namespace nofacet {

// A tangent shorter than this part of the other one is taken for degenerate.
inline constexpr double kDegenerate = 1e-6;
// Tangents span no plane if their product is smaller than this part of the product of their lengths.
inline constexpr double kFlat = 1e-9;

// The two tangents of a surface, as long as its derivatives.
struct Tangents {
  double a[3], b[3];

  // From the homogeneous point and derivatives (x, y, z, w) of a surface, w last.
  Tangents(const double p[4], const double pa[4], const double pb[4]);
  // Whether one of them is so short that its direction is rounding.
  bool degenerate() const;
  // Unit cross product; false if the tangents span no plane.
  bool cross(double normal[3]) const;
};

// The tangents of a patch at its parameters (s, t). Where they span no plane, their limits from inside the patch, of
// another length but in the same sense.
Tangents limit_tangents(const Net& net, double s, double t);

// Unit normal in eye space of a placed face at the parameters (s, t) of one of its patches, from the patch itself.
// Where a tangent vanishes, the limit from inside the patch.
void patch_normal(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch, double s,
                  double t, double normal[3]);

}  // namespace nofacet
