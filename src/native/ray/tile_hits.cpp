#include "ray/tile_hits.h"

#include <algorithm>
#include <cmath>

#include "raster/scan_planes.h"
#include "raster/screen_jet.h"

namespace nofacet {
namespace {

constexpr double kSameWay = 1e-3;  // radians between two surfaces that may be one

// How the depth at a hit changes along the surface by the picture's x and y. NaN on a cap, which has no net; may be
// infinite beside a silhouette.
struct DepthSlopes {
  double by_x, by_y;

  explicit DepthSlopes(const RayHit& hit) : by_x(NAN), by_y(NAN) {
    if (!hit.patch->net.points) return;
    const ScreenJet at(evaluate(hit.patch->net, hit.s, hit.t));
    const double key = (hit.patch->perspective ? -hit.depth * hit.depth : 1.0) / at.jacobian();  // or 1 / depth
    by_x = key * (at.ka * at.yb - at.kb * at.ya), by_y = key * (at.kb * at.xa - at.ka * at.xb);
  }
};

}  // namespace

void TileHits::reset(int rays) {
  farthest_.assign(rays + SolvedRays::kPadding, INFINITY);
  std::fill(farthest_.begin() + rays, farthest_.end(), -INFINITY);
  hits_.resize(rays);
  for (RayHit& hit : hits_) hit.patch = nullptr, hit.depth = INFINITY;
  veils_.clear();
  farthest_of_all_ = INFINITY;
  changed_ = false;
}

bool TileHits::shown_before(const RayHit& hit, const RayHit& other) const {
  if (!other.patch) return true;
  const double farther = hit.depth - other.depth;
  if (std::fabs(farther) > scene_.tie) return farther < 0;
  const DepthSlopes p(hit), q(other);
  const double pixels = camera_.pixels_at(hit.depth), by_x = p.by_x - q.by_x, by_y = p.by_y - q.by_y;
  // The cross product of the normals (-p, 1) and (-q, 1), and their lengths.
  const auto square = [&](double x, double y) { return pixels * pixels * (x * x + y * y); };
  const double across = pixels * pixels * (p.by_x * q.by_y - p.by_y * q.by_x);
  const double sine = square(by_x, by_y) + across * across,
               lengths = (1.0 + square(p.by_x, p.by_y)) * (1.0 + square(q.by_x, q.by_y));
  if (sine > kSameWay * kSameWay * lengths) return farther + kSampleShiftX * by_x + kSampleShiftY * by_y < 0;
  return hit.patch->face < other.patch->face;
}

void TileHits::add(const RayPatch& patch, const Region* region, const SolvedRays& solved) {
  const bool veil = scene_.transparent && scene_.lets_light_through(patch);
  const Scene::PatchRef& ref = *patch.patch;
  for (int k = 0; k < solved.count; ++k) {
    const int ray = int(solved.ray[k]);
    const RayHit hit{&patch,
                     solved.depth[k],
                     solved.s[k],
                     solved.t[k],
                     {solved.normal[0][k], solved.normal[1][k], solved.normal[2][k]}};
    if (veil ? hit.depth > farthest_[ray] : !shown_before(hit, hits_[ray])) continue;
    if (region && !region->contains(ref.u.face_from_patch(solved.s_in[k]), ref.v.face_from_patch(solved.t_in[k]))) {
      continue;
    }
    keep(ray, hit, veil);
  }
}

void TileHits::show(int ray, const RayHit& hit) {
  const bool veil = scene_.transparent && scene_.lets_light_through(*hit.patch);
  if (veil ? hit.depth <= farthest_[ray] : shown_before(hit, hits_[ray])) keep(ray, hit, veil);
}

void TileHits::keep(int ray, const RayHit& hit, bool veil) {
  if (veil) {
    veils_.push_back({ray, hit});
    return;
  }
  hits_[ray] = hit;
  farthest_[ray] = hit.depth + scene_.tie;
  changed_ = true;
}

void TileHits::end_patch() {
  if (!changed_) return;
  changed_ = false;
  farthest_of_all_ = *std::max_element(farthest_.begin(), farthest_.end());
}

void TileHits::sort_veils() {
  std::erase_if(veils_, [&](const Veil& veil) { return !shown_before(veil.hit, hits_[veil.ray]); });
  std::stable_sort(veils_.begin(), veils_.end(), [](const Veil& p, const Veil& q) {
    return p.ray != q.ray ? p.ray < q.ray : p.hit.depth < q.hit.depth;
  });
  // A root on the border of two parts of a patch is found twice.
  const auto same = [&](const Veil& p, const Veil& q) {
    return p.ray == q.ray && p.hit.patch == q.hit.patch && q.hit.depth - p.hit.depth <= scene_.tie;
  };
  veils_.erase(std::unique(veils_.begin(), veils_.end(), same), veils_.end());
}

}  // namespace nofacet
