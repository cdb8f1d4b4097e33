#include "raster/shade.h"

#include <cmath>

namespace nofacet {
namespace {

// Cross product of the eye-space tangents; returns its length relative to theirs.
double tangent_cross(const Camera& camera, const Jet& jet, double view[3], double normal[3]) {
  double p[4], pa[4], pb[4], ta[3], tb[3];
  camera.unproject(jet.p, p);
  camera.unproject(jet.pa, pa);
  camera.unproject(jet.pb, pb);
  for (int c = 0; c < 3; ++c) {
    view[c] = p[c] / p[3];
    ta[c] = pa[c] - view[c] * pa[3];
    tb[c] = pb[c] - view[c] * pb[3];
  }
  for (int c = 0; c < 3; ++c) normal[c] = ta[(c + 1) % 3] * tb[(c + 2) % 3] - ta[(c + 2) % 3] * tb[(c + 1) % 3];
  const double length = std::sqrt(Camera::dot(normal, normal));
  const double sizes = std::sqrt(Camera::dot(ta, ta) * Camera::dot(tb, tb));
  if (length > 0) {
    for (int c = 0; c < 3; ++c) normal[c] /= length;
  }
  if (!camera.perspective) view[0] = view[1] = 0.0, view[2] = 1.0;
  const double largest = std::max(Camera::dot(ta, ta), Camera::dot(tb, tb));
  return largest > 0 ? length / std::max(sizes, 1e-9 * largest) : 0.0;
}

}  // namespace

void surface_normal(const Piece& piece, const Camera& camera, const SurfaceSample& sample, double normal[3]) {
  double view[3];
  double quality = tangent_cross(camera, sample.jet, view, normal);
  // A degenerate point: step towards the middle of the piece until the tangents span a plane.
  for (double step = 1e-7; quality < 1e-7 && step < 1.0; step *= 10.0) {
    const double a = sample.a + step * (0.5 - sample.a), b = sample.b + step * (0.5 - sample.b);
    quality = tangent_cross(camera, evaluate(piece.net, a, b), view, normal);
  }
  if (Camera::dot(normal, view) > 0) {
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
  const double facing = std::min(1.0, std::fabs(Camera::dot(normal, towards_eye)));
  // The light stands a little above and to the left of the eye, so that faces tilted either way differ.
  constexpr double kKey[3] = {-0.29, 0.35, -0.89};
  const double key = std::max(0.0, Camera::dot(normal, kKey));
  const double world_up = camera.right[2] * normal[0] + camera.up[2] * normal[1] + camera.forward[2] * normal[2];
  const double sky = 0.5 + 0.5 * world_up;
  const double half[3] = {kKey[0] + towards_eye[0], kKey[1] + towards_eye[1], kKey[2] + towards_eye[2]};
  const double gloss = std::max(0.0, Camera::dot(normal, half) / std::sqrt(Camera::dot(half, half)));
  const double gloss2 = gloss * gloss, gloss8 = gloss2 * gloss2 * gloss2 * gloss2;
  const double diffuse = 0.10 + 0.17 * sky + 0.25 * facing + 0.48 * key;
  const double highlight = 0.10 * gloss8 * gloss8 * gloss8 * gloss8;
  for (int c = 0; c < 3; ++c) rgb[c] = float(std::min(1.0, color[c] * diffuse + highlight));
}

}  // namespace nofacet
