// The exact map between a patch's own parameter s in [0, 1] and the face's OpenCascade parameter u in [u0, u1].
#pragma once
#include <cmath>

namespace nofacet {

// Linear, or for an angle (a circle's arc as a rational quadratic): u = m + 2 atan(T (2 s - 1)), with m the middle of
// the arc and T = tan((u1 - u0) / 4).
struct ParameterMap {
  double u0 = 0.0, u1 = 1.0;
  bool angular = false;
  double tangent = 0.0;

  ParameterMap() = default;
  ParameterMap(double first, double last, bool is_angle)
      : u0(first), u1(last), angular(is_angle), tangent(is_angle ? std::tan(0.25 * (last - first)) : 0.0) {}

  double face_from_patch(double s) const {
    if (!angular) return (1.0 - s) * u0 + s * u1;
    return 0.5 * (u0 + u1) + 2.0 * std::atan(tangent * (2.0 * s - 1.0));
  }
  double patch_from_face(double u) const {
    if (!angular) return (u - u0) / (u1 - u0);
    return 0.5 + 0.5 * std::tan(0.5 * (u - 0.5 * (u0 + u1))) / tangent;
  }
  // s and ds/du at u.
  struct Local {
    double s, slope;
  };
  Local local(double u) const {
    if (!angular) return {(u - u0) / (u1 - u0), 1.0 / (u1 - u0)};
    const double t = std::tan(0.5 * (u - 0.5 * (u0 + u1)));
    return {0.5 + 0.5 * t / tangent, 0.25 * (1.0 + t * t) / tangent};
  }
};

}  // namespace nofacet
