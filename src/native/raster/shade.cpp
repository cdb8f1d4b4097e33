#include "raster/shade.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kTinyPiece = 1e-5;

double length(const double* v) { return std::sqrt(Camera::dot(v, v)); }

struct Tangents {
  double a[3], b[3];

  // From the homogeneous point and derivatives (x, y, z, w) of a surface, w last.
  Tangents(const double p[4], const double pa[4], const double pb[4]) {
    for (int c = 0; c < 3; ++c) {
      a[c] = pa[c] - p[c] / p[3] * pa[3];
      b[c] = pb[c] - p[c] / p[3] * pb[3];
    }
  }
  bool degenerate() const {
    const double la = length(a), lb = length(b);
    return !(la >= kDegenerate * lb && lb >= kDegenerate * la);
  }
  // Unit cross product; false if the tangents span no plane.
  bool cross(double normal[3]) const {
    for (int c = 0; c < 3; ++c) normal[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    const double size = length(normal);
    if (!(size > kFlat * length(a) * length(b))) return false;
    for (int c = 0; c < 3; ++c) normal[c] /= size;
    return true;
  }
};

// Tangents of the patch itself at its (s, t), in its own coordinates. Where one of them vanishes, at a pole or a cone's
// tip, its direction is the limit from inside: the mixed derivative.
Tangents patch_tangents(const Net& net, double s, double t) {
  const Jet jet = evaluate(net, s, t);
  Tangents result(jet.p, jet.pa, jet.pb);
  if (!result.degenerate()) return result;
  double mixed[4];
  evaluate_mixed(net, s, t, mixed);
  double* shorter = length(result.a) < length(result.b) ? result.a : result.b;
  double limit[3];
  for (int c = 0; c < 3; ++c) {
    limit[c] =
        mixed[c] - jet.p[c] / jet.p[3] * mixed[3] - (result.a[c] * jet.pb[3] + result.b[c] * jet.pa[3]) / jet.p[3];
  }
  std::copy_n(limit, 3, shorter);
  return result;
}

// Unit normal in eye space from the patch, for where the piece's own derivatives do not serve.
void patch_normal(const Scene& scene, const Piece& piece, const Camera& camera, double a, double b, double normal[3]) {
  const PatchGroup& group = scene.model.groups[piece.patch->group];
  Net net{group.degree_u, group.degree_v, nullptr};
  net.points = group.control_points + net.size() * piece.patch->index;
  if (piece.transposed) std::swap(a, b);
  const double s = piece.s0 + a * (piece.s1 - piece.s0), t = piece.t0 + b * (piece.t1 - piece.t0);
  Tangents local = patch_tangents(net, s, t);
  bool found = local.cross(normal);
  // Degenerate beyond a pole: the limit is approached from the middle of the patch.
  for (double step = 1e-6; !found && step < 1.0; step *= 10.0) {
    local = patch_tangents(net, s + step * (0.5 - s), t + step * (0.5 - t));
    found = local.cross(normal);
  }
  const double* placement = scene.model.placements + 16 * std::size_t(scene.model.face_placement[piece.face]);
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

}  // namespace

bool is_tiny(const Piece& piece) { return piece.s1 - piece.s0 < kTinyPiece || piece.t1 - piece.t0 < kTinyPiece; }

void surface_normal(const Scene& scene, const Piece& piece, const Camera& camera, const SurfaceSample& sample,
                    double normal[3]) {
  double p[4], pa[4], pb[4];
  camera.unproject(sample.jet.p, p);
  camera.unproject(sample.jet.pa, pa);
  camera.unproject(sample.jet.pb, pb);
  const Tangents tangents(p, pa, pb);
  if (is_tiny(piece) || tangents.degenerate() || !tangents.cross(normal)) {
    patch_normal(scene, piece, camera, sample.a, sample.b, normal);
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
  const double facing = std::min(1.0, std::fabs(Camera::dot(normal, towards_eye)));
  const double key = std::max(0.0, Camera::dot(normal, kKeyLight));
  const double world_up = camera.right[2] * normal[0] + camera.up[2] * normal[1] + camera.forward[2] * normal[2];
  const double sky = 0.5 + 0.5 * world_up;
  const double half[3] = {kKeyLight[0] + towards_eye[0], kKeyLight[1] + towards_eye[1], kKeyLight[2] + towards_eye[2]};
  const double gloss = std::max(0.0, Camera::dot(normal, half) / std::sqrt(Camera::dot(half, half)));
  const double gloss2 = gloss * gloss, gloss8 = gloss2 * gloss2 * gloss2 * gloss2;
  const double diffuse = kAmbient + kSky * sky + kFacing * facing + kKey * key;
  const double highlight = kGloss * gloss8 * gloss8 * gloss8 * gloss8;
  for (int c = 0; c < 3; ++c) rgb[c] = float(std::min(1.0, color[c] * diffuse + highlight));
}

}  // namespace nofacet
