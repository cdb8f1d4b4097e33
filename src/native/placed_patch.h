// A patch of a face where the face stands, as the camera sees it.
#pragma once
#include <cstdint>

#include "bezier/net.h"
#include "camera.h"
#include "scene.h"

namespace nofacet {

// The patch's control points (wx, wy, wz, w) as the model has them, in the definition's own coordinates: here X, Y, W,
// Z do not mean what they mean on the screen, the weight is last.
Net patch_net(const Scene& scene, const Scene::PatchRef& patch);

// Writes the patch's control points as homogeneous screen points (camera.h): 4 (n + 1) (m + 1) values.
void project_patch(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch, double* out);

// True if no point of the projected net can be in front of the eye and inside the image: every control point lies
// beyond one of the frustum's planes, in homogeneous form, so it holds for nets that cross the eye plane too. In a side
// view also if the net crosses the eye plane and what is in front of it lies beside the picture, on the nearer side.
bool is_off_screen(const Net& net, const Camera& camera);

}  // namespace nofacet
