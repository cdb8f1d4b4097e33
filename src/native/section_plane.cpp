#include "section_plane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bezier/net.h"

namespace nofacet {
namespace {

// Of the model's size, and of the coordinates themselves for models far from the origin.
constexpr double kShift = 1e-11, kRoundingShift = 64.0 * std::numeric_limits<double>::epsilon();

struct Box {
  Interval range[3] = {Interval::empty(), Interval::empty(), Interval::empty()};

  explicit Box(const Scene& scene) {
    const Model& model = scene.model;
    for (std::size_t face = 0; face < model.face_count; ++face) {
      const double* placement = model.placements + 16 * std::size_t(model.face_placement[face]);
      const int32_t d = model.face_definition[face];
      for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
        include_corners(model.groups[scene.patches[k].group], scene.patches[k].index, placement);
      }
    }
  }

  void include_corners(const PatchGroup& group, int32_t patch, const double* placement) {
    const std::size_t n = group.degree_u, m = group.degree_v;
    const double* net = group.control_points + 4 * (n + 1) * (m + 1) * patch;
    for (const std::size_t corner : {std::size_t(0), m, n * (m + 1), n * (m + 1) + m}) {
      const double* p = net + 4 * corner;
      for (int r = 0; r < 3; ++r) range[r].include(Camera::dot(placement + 4 * r, p) / p[3] + placement[4 * r + 3]);
    }
  }
};

void set_form(const Camera& camera, const SectionPlane& section, double shift, double form[4]) {
  const double right = Camera::dot(section.normal, camera.right), up = Camera::dot(section.normal, camera.up);
  const double forward = Camera::dot(section.normal, camera.forward);
  const double from_plane[3] = {camera.eye[0] - section.origin[0], camera.eye[1] - section.origin[1],
                                camera.eye[2] - section.origin[2]};
  const double eye = Camera::dot(section.normal, from_plane) + shift;
  form[kX] = right / camera.scale;
  form[kY] = -up / camera.scale;
  form[kW] = (0.5 * camera.height * up - 0.5 * camera.width * right) / camera.scale;
  form[kW] += camera.perspective ? forward : eye;
  form[kZ] = camera.perspective ? -eye : forward;
}

}  // namespace

SectionForm::SectionForm(const Camera& camera, const SectionPlane& section, double moved) : shift(moved) {
  set_form(camera, section, 0.0, plane);
  set_form(camera, section, shift, inner);
  set_form(camera, section, -shift, outer);
}

double SectionForm::value(const double form[4], const double point[4]) {
  return form[kX] * point[kX] + form[kY] * point[kY] + form[kW] * point[kW] + form[kZ] * point[kZ];
}

double model_size(const Scene& scene) {
  const Box box(scene);
  return std::hypot(box.range[0].width(), box.range[1].width(), box.range[2].width());
}

double section_shift(const Scene& scene, const std::vector<SectionPlane>& sections) {
  double magnitude = 0.0;
  for (const Interval& range : Box(scene).range) magnitude = std::max(magnitude, range.magnitude());
  for (const SectionPlane& section : sections) {
    for (const double c : section.origin) magnitude = std::max(magnitude, std::fabs(c));
  }
  return kShift * model_size(scene) + kRoundingShift * magnitude;
}

}  // namespace nofacet
