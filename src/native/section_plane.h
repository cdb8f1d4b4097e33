// Section planes, and on which side of them a point of the screen lies.
//
// Faces may lie in a section plane, or end on it, but for rounding. Decisions are therefore taken on a plane moved
// into what is kept, by far more than rounding and far less than anything visible; values are those of the plane
// itself.
#pragma once
#include <vector>

#include "camera.h"
#include "scene.h"

namespace nofacet {

// What lies on the side of `origin` that `normal` points to is cut away.
struct SectionPlane {
  double origin[3], normal[3];  // world; the normal of unit length
};

// A plane's distance as linear forms of homogeneous screen points (X, Y, W, Z): times a positive weight, positive where
// points are cut away.
struct SectionForm {
  double plane[4];  // the plane itself
  double inner[4];  // moved into what is kept: decides
  double outer[4];  // moved as far the other way: what lies in the plane passes for kept
  double shift;     // of these two, model units

  SectionForm() = default;
  SectionForm(const Camera& camera, const SectionPlane& section, double shift);

  static double value(const double form[4], const double point[4]);
  static double value(const double form[4], double x, double y, double key) {
    const double point[4] = {x, y, 1.0, key};
    return value(form, point);
  }
  // The plane's key at a point of the screen.
  double key(double x, double y) const { return -(plane[0] * x + plane[1] * y + plane[2]) / plane[3]; }
};

// The diagonal of the box around all patches' corners.
double model_size(const Scene& scene);
// By how much the first plane's decisions are moved; the second's by twice as much and so on, so that of planes given
// twice one has the cap.
double section_shift(const Scene& scene, const std::vector<SectionPlane>& sections);

}  // namespace nofacet
