#include "patch_normal.h"

#include <algorithm>
#include <cmath>

#include "placed_patch.h"

namespace nofacet {
namespace {

double length(const double* v) { return std::sqrt(Camera::dot(v, v)); }

// Tangents of a net at its (s, t). Where one of them vanishes, at a pole or a cone's tip, its direction is the limit
// from inside: the mixed derivative, or its opposite at the far border.
Tangents net_tangents(const Net& net, double s, double t) {
  const Jet jet = evaluate(net, s, t);
  Tangents result(jet.p, jet.pa, jet.pb);
  if (!result.degenerate()) return result;
  double mixed[4];
  evaluate_mixed(net, s, t, mixed);
  const bool a_vanishes = length(result.a) < length(result.b);
  double* shorter = a_vanishes ? result.a : result.b;
  const double inwards = (a_vanishes ? t : s) < 0.5 ? 1.0 : -1.0;
  double limit[3];
  for (int c = 0; c < 3; ++c) {
    limit[c] = inwards * (mixed[c] - jet.p[c] / jet.p[3] * mixed[3] -
                          (result.a[c] * jet.pb[3] + result.b[c] * jet.pa[3]) / jet.p[3]);
  }
  std::copy_n(limit, 3, shorter);
  return result;
}

}  // namespace

Tangents::Tangents(const double p[4], const double pa[4], const double pb[4]) {
  for (int c = 0; c < 3; ++c) {
    a[c] = pa[c] - p[c] / p[3] * pa[3];
    b[c] = pb[c] - p[c] / p[3] * pb[3];
  }
}

bool Tangents::degenerate() const {
  const double la = length(a), lb = length(b);
  return !(la >= kDegenerate * lb && lb >= kDegenerate * la);
}

bool Tangents::cross(double normal[3]) const {
  for (int c = 0; c < 3; ++c) normal[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  const double size = length(normal);
  if (!(size > kFlat * length(a) * length(b))) return false;
  for (int c = 0; c < 3; ++c) normal[c] /= size;
  return true;
}

Tangents limit_tangents(const Net& net, double s, double t) {
  double normal[3];
  Tangents local = net_tangents(net, s, t);
  bool found = local.cross(normal);
  // Degenerate beyond a pole: the limit is approached from the middle of the patch.
  for (double step = 1e-6; !found && step < 1.0; step *= 10.0) {
    local = net_tangents(net, s + step * (0.5 - s), t + step * (0.5 - t));
    found = local.cross(normal);
  }
  return local;
}

void patch_normal(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch, double s,
                  double t, double normal[3]) {
  Tangents local = limit_tangents(patch_net(scene, patch), s, t);
  const double* placement = scene.model.placements + 16 * std::size_t(scene.model.face_placement[face]);
  const double* axes[3] = {camera.right, camera.up, camera.forward};
  auto to_eye = [&](double* v) {
    double world[3], eye[3];
    for (int r = 0; r < 3; ++r) world[r] = Camera::dot(placement + 4 * r, v);
    for (int c = 0; c < 3; ++c) eye[c] = Camera::dot(axes[c], world);
    std::copy_n(eye, 3, v);
  };
  to_eye(local.a);
  to_eye(local.b);
  local.cross(normal);
}

}  // namespace nofacet
