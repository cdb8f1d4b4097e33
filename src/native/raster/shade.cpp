#include "raster/shade.h"

#include <cmath>

#include "light.h"
#include "patch_normal.h"

namespace nofacet {
namespace {

// A piece smaller than this part of its patch has lost the digits that its derivatives are made of.
constexpr double kTinyPiece = 1e-5;

// Unit normal in eye space from the patch, for where the piece's own derivatives do not serve.
void normal_of_patch(const Scene& scene, const Piece& piece, const Camera& camera, double a, double b,
                     double normal[3]) {
  if (piece.transposed) std::swap(a, b);
  const double s = piece.s0 + a * (piece.s1 - piece.s0), t = piece.t0 + b * (piece.t1 - piece.t0);
  patch_normal(scene, camera, piece.face, *piece.patch, s, t, normal);
}

// Unit normal in eye space of the plane on which the key is linear.
void plane_normal(const KeyPlane& plane, const Camera& camera, double normal[3]) {
  const double at_centre = plane.key(0.5 * camera.width, 0.5 * camera.height);
  normal[0] = camera.scale * plane.by_x;
  normal[1] = -camera.scale * plane.by_y;
  normal[2] = camera.perspective ? at_centre : -1.0;
  const double length = std::sqrt(Camera::dot(normal, normal));
  for (int c = 0; c < 3; ++c) normal[c] /= length;
}

}  // namespace

bool is_tiny(const Piece& piece) { return piece.s1 - piece.s0 < kTinyPiece || piece.t1 - piece.t0 < kTinyPiece; }

void surface_normal(const Scene& scene, const Piece& piece, const Camera& camera, const SurfaceSample& sample,
                    double normal[3]) {
  double p[4], pa[4], pb[4];
  camera.unproject(sample.jet.p, p);
  camera.unproject(sample.jet.pa, pa);
  camera.unproject(sample.jet.pb, pb);
  const Tangents tangents(p, pa, pb);
  if (scene.is_cap(piece.face)) {
    plane_normal(piece.hull.plane, camera, normal);
  } else if (is_tiny(piece) || tangents.degenerate() || !tangents.cross(normal)) {
    normal_of_patch(scene, piece, camera, sample.a, sample.b, normal);
  }
  const double towards_back = camera.perspective ? Camera::dot(normal, p) * p[3] : normal[2];
  if (towards_back > 0) {
    for (int c = 0; c < 3; ++c) normal[c] = -normal[c];
  }
}

void shade(const Camera& camera, const SurfaceSample& sample, const double normal[3], const float color[4],
           float rgb[3]) {
  double p[4], towards_eye[3] = {0.0, 0.0, -1.0};
  if (camera.perspective) {
    camera.unproject(sample.jet.p, p);
    const double length = std::sqrt(Camera::dot(p, p));
    for (int c = 0; c < 3; ++c) towards_eye[c] = -p[c] / length;
  }
  light(camera, normal, towards_eye, color, rgb);
}

}  // namespace nofacet
