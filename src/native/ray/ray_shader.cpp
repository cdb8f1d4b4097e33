#include "ray/ray_shader.h"

#include <algorithm>
#include <cmath>

#include "light.h"
#include "patch_normal.h"

namespace nofacet {

RayShader::RayShader(const Scene& scene, const Camera& camera, const RenderOptions& options, const PartTree* tree,
                     double tie)
    : scene_(scene), camera_(camera), shadows_(options.shadows), reflectance_(options.reflectance) {
  if (tree) secondary_.emplace(scene, *tree, tie);
}

void RayShader::normal(const RayHit& hit, const double direction[3], double normal[3]) const {
  std::copy_n(hit.normal, 3, normal);
  if (Camera::dot(normal, normal) > 0.0) return;
  patch_normal(scene_, camera_, hit.patch->face, *hit.patch->patch, hit.s, hit.t, normal);
  if (Camera::dot(normal, direction) > 0.0) {
    for (int c = 0; c < 3; ++c) normal[c] = -normal[c];
  }
}

void RayShader::add(const RayHit& hit, const double point[3], const double direction[3], double transmitted,
                    double rgba[4], int bounce) {
  const float* color = scene_.color(hit.patch->face);
  const double opacity = std::min(1.0f, color[3]) * transmitted;
  const double towards_viewer[3] = {-direction[0], -direction[1], -direction[2]};
  double n[3];
  normal(hit, direction, n);
  float rgb[3];
  light(camera_, n, towards_viewer, color, rgb, !shadows_ || key_light_reaches(point, n));
  double own = 1.0, seen[4] = {0, 0, 0, 0};
  if (reflectance_ > 0.0 && bounce < kBounces) {
    const double along = 2.0 * Camera::dot(direction, n);
    const double mirrored[3] = {direction[0] - along * n[0], direction[1] - along * n[1], direction[2] - along * n[2]};
    own = 1.0 - reflectance_;
    add_seen(point, mirrored, bounce + 1, seen);
  }
  for (int c = 0; c < 3; ++c) rgba[c] += opacity * (own * rgb[c] + reflectance_ * seen[c]);
  rgba[3] += opacity * (own + reflectance_ * seen[3]);
}

// Adds everything in one direction from a point, through transparent faces to the first opaque one.
void RayShader::add_seen(const double origin[3], const double direction[3], int bounce, double rgba[4]) {
  double start[3], transmitted = 1.0;
  std::copy_n(origin, 3, start);
  for (int layer = 0; layer < kLayers && transmitted > 0.0; ++layer) {
    const RayHit hit = secondary_->nearest(start, direction);
    if (!hit.patch) return;
    for (int c = 0; c < 3; ++c) start[c] += hit.depth * direction[c];
    add(hit, start, direction, transmitted, rgba, bounce);
    transmitted *= 1.0 - std::min(1.0f, scene_.model.face_color[4 * std::size_t(hit.patch->face) + 3]);
  }
}

bool RayShader::key_light_reaches(const double point[3], const double normal[3]) {
  if (!(Camera::dot(normal, kKeyLight) > 0.0)) return true;  // turned away: it lights nothing here
  const double length = std::sqrt(Camera::dot(kKeyLight, kKeyLight));
  const double direction[3] = {kKeyLight[0] / length, kKeyLight[1] / length, kKeyLight[2] / length};
  return !secondary_->blocked(point, direction);
}

}  // namespace nofacet
