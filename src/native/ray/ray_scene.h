// All placed patches as a frame's primary rays meet them.
#pragma once
#include <vector>

#include "arena.h"
#include "camera.h"
#include "ray/ray_patch.h"
#include "scene.h"

namespace nofacet {

// Projects every patch once a frame. Memory: a projected net (32 bytes a control point) and a RayPatch (about 150
// bytes) for each placed patch that may be on screen.
class RayScene {
 public:
  RayScene(const Scene& scene, const Camera& camera, int threads);

  // In the order of faces and their patches, whatever the threads.
  std::vector<RayPatch> patches;
  // Depths this close are one and the same surface; the face with the lower index is shown.
  double tie = 0.0;
  bool transparent = false;  // whether any patch is of a face that lets light through

  bool lets_light_through(const RayPatch& patch) const { return scene_.color(patch.face)[3] < 1.0f; }

 private:
  const Scene& scene_;
  std::vector<Arena<double>> nets_;  // per thread
};

// project_patch(), but in perspective with w instead of -w for Z: rays measure depth as W / Z with a positive
// denominator.
void project_ray_patch(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch,
                       double* out);

}  // namespace nofacet
