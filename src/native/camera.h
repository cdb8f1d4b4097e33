// The camera as the contract's file describes it, and the projective map from world to pixels.
#pragma once

namespace nofacet {

// A plane that a side view looks along (raster/sections.h).
struct SidePlane {
  double normal[3], origin[3];  // the normal of unit length
  int picture_width;            // of the camera whose side view it is
  bool near_right;              // where the plane's horizontals come towards the eye: at x = +inf, else at -inf
};

struct Camera {
  double eye[3];
  double right[3], up[3], forward[3];  // orthonormal
  double scale;                        // pixels per model unit (orthographic) or per unit of slope (perspective)
  bool perspective;
  int width, height;
  // Null except in a side view: then x is the distance from the plane, 0 at width / 2, and the key is the x of the
  // camera whose side view it is; y and W are that camera's own.
  const SidePlane* side = nullptr;

  // Homogeneous screen point (X, Y, W, Z) of the homogeneous world point (wx, wy, wz, w): x = X / W and y = Y / W in
  // pixels, key = Z / W. The key grows with depth and is linear in x and y on every plane: orthographic, it is the
  // depth; perspective, -1 / depth. In front of the eye W > 0.
  // The eye is subtracted before anything is scaled, so a model far from the origin loses no digits here.
  void project(const double world[4], double screen[4]) const {
    const double w = world[3];
    const double p[3] = {world[0] - eye[0] * w, world[1] - eye[1] * w, world[2] - eye[2] * w};
    const double x = dot(right, p), y = dot(up, p), z = dot(forward, p);
    const double weight = perspective ? z : w;
    screen[0] = 0.5 * width * weight + scale * x;
    screen[1] = 0.5 * height * weight - scale * y;
    screen[2] = weight;
    screen[3] = perspective ? -w : z;
    if (side) {
      const double* o = side->origin;
      const double q[3] = {world[0] - o[0] * w, world[1] - o[1] * w, world[2] - o[2] * w};
      screen[3] = 0.5 * side->picture_width * weight + scale * x;
      screen[0] = 0.5 * width * weight + scale * dot(side->normal, q);
    }
  }
  // Homogeneous eye-space point (right, up, forward, w) of a screen point or of its derivative.
  void unproject(const double screen[4], double eye_space[4]) const {
    eye_space[0] = (screen[0] - 0.5 * width * screen[2]) / scale;
    eye_space[1] = (0.5 * height * screen[2] - screen[1]) / scale;
    eye_space[2] = perspective ? screen[2] : screen[3];
    eye_space[3] = perspective ? -screen[3] : screen[2];
  }
  // Pixels per model unit at a depth.
  double pixels_at(double depth) const { return perspective ? scale / depth : scale; }
  double depth(double key) const { return perspective ? -1.0 / key : key; }
  double depth(const double screen[4]) const { return depth(screen[3] / screen[2]); }

  static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
};

}  // namespace nofacet
