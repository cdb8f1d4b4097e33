// What the rays of one tile hit.
#pragma once
#include <vector>

#include "ray/clipper.h"
#include "ray/ray_scene.h"

namespace nofacet {

// A point in which a ray meets a surface.
struct RayHit {
  const RayPatch* patch;  // null: none
  double depth;
  double s, t;       // of the patch
  double normal[3];  // eye space; zero: the derivatives give none
};

// Keeps the nearest opaque hit of each ray, and the transparent ones in front of it.
// Memory: 64 bytes a ray of the tile, and 64 a transparent hit.
class TileHits final : public HitSink {
 public:
  // A transparent hit, and whose ray's it is.
  struct Veil {
    int ray;
    RayHit hit;
  };

  TileHits(const RayScene& scene, const Camera& camera) : scene_(scene), camera_(camera) {}

  // Forgets everything; `rays` may be hit.
  void reset(int rays);
  // To be called when another patch has been traced.
  void end_patch();
  // To be called when all patches have been: the veils hidden by opaque hits go, the others come in the order of
  // rays, for each from the nearest to the farthest.
  void sort_veils();

  const RayHit& opaque(int ray) const { return hits_[ray]; }
  const std::vector<Veil>& veils() const { return veils_; }
  // Of two hits of a ray, whether the first is the one shown. Depths that are tied are those of one surface only if the
  // surfaces run the same way there; else they meet, and what is nearer where the ray is decides.
  bool shown_before(const RayHit& hit, const RayHit& other) const;

  bool hidden(double nearest) const override { return nearest > farthest_of_all_; }
  const double* farthest() const override { return farthest_.data(); }
  void add(const RayPatch& patch, const Region* region, const SolvedRays& solved) override;
  // Takes a hit that is inside its region.
  void show(int ray, const RayHit& hit);

 private:
  void keep(int ray, const RayHit& hit, bool veil);

  const RayScene& scene_;
  const Camera& camera_;
  std::vector<double> farthest_;  // depth of the opaque hit, and the tie tolerance more
  std::vector<RayHit> hits_;
  std::vector<Veil> veils_;
  double farthest_of_all_ = INFINITY;
  bool changed_ = false;
};

}  // namespace nofacet
