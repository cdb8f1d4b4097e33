#include "placed_patch.h"

namespace nofacet {

Net patch_net(const Scene& scene, const Scene::PatchRef& patch) {
  const PatchGroup& group = scene.model.groups[patch.group];
  Net net{group.degree_u, group.degree_v, nullptr};
  net.points = group.control_points + net.size() * patch.index;
  return net;
}

void project_patch(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch, double* out) {
  const PatchGroup& group = scene.model.groups[patch.group];
  const double* placement = scene.model.placements + 16 * std::size_t(scene.model.face_placement[face]);
  const std::size_t size = 4 * std::size_t(group.degree_u + 1) * (group.degree_v + 1);
  const double* source = group.control_points + size * patch.index;
  for (std::size_t k = 0; k < size; k += 4) {
    double world[4];
    for (int r = 0; r < 3; ++r) {
      world[r] = Camera::dot(placement + 4 * r, source + k) + placement[4 * r + 3] * source[k + 3];
    }
    world[3] = source[k + 3];
    camera.project(world, out + k);
  }
}

bool is_off_screen(const Net& net, const Camera& camera) {
  bool behind = true, left = true, right = true, above = true, below = true, nearer = camera.side, in_front = true;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    behind &= p[kW] <= 0;
    left &= p[kX] < 0;
    right &= p[kX] > camera.width * p[kW];
    above &= p[kY] < 0;
    below &= p[kY] > camera.height * p[kW];
    if (!camera.side) continue;
    nearer &= camera.side->near_right ? p[kZ] > camera.side->picture_width * p[kW] : p[kZ] < 0;
    in_front &= p[kW] > 0;
  }
  return behind || left || right || above || below || (nearer && !in_front);
}

}  // namespace nofacet
