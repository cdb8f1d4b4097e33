// Where a face is, which way it looks and how it bends at given parameters: the facts of a point, not of a picture.
#pragma once
#include <cstddef>
#include <cstdint>

#include "scene.h"

namespace nofacet {

// Where the results go, world coordinates, n rows each.
struct SurfacePointArrays {
  double* position;   // (n, 3)
  double* normal;     // (n, 3): unit, out of the material
  double* curvature;  // (n, 2): principal curvatures, the larger first; positive where it bends towards the normal
  double* direction;  // (n, 2, 3): unit tangents along which the surface bends by these; right-handed with the normal
};

// Evaluates placed faces (n,) at OpenCascade's parameters uv (n, 2), from their patches: homogeneous derivatives up to
// the second order, and the shape operator in an orthonormal frame of the tangent plane. Beyond the face's patches the
// nearest one is continued. NaN throughout for a face without patches, a negative face or parameters that are not
// finite. At a pole or a cone's tip the normal is the limit from inside the patch; the curvatures and directions are
// NaN there, as they depend on where one comes from, and wherever rounding leaves them less than four digits.
void evaluate_surface(const Scene& scene, const int32_t* face, const double* uv, std::size_t n,
                      const SurfacePointArrays& out);

}  // namespace nofacet
