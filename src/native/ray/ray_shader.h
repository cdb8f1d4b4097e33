// What a ray sees of the point it hits: light, shadow, mirror image.
#pragma once
#include <optional>

#include "methods.h"
#include "ray/secondary_rays.h"

namespace nofacet {

// One per thread.
//
// Shadows: an exact ray towards the key light, past transparent faces; in shadow the key light and its highlight are
// missing. Mirror: every face reflects the share `reflectance`, a mirrored ray again, kBounces times in all. A
// mirrored ray that leaves the model sees the frame's background: that share of the colour's alpha stays open.
class RayShader {
 public:
  static constexpr int kBounces = 4;
  static constexpr int kLayers = 64;  // of transparent faces that a mirrored ray passes

  // `tree` may be null if the options ask for neither shadows nor reflectance.
  RayShader(const Scene& scene, const Camera& camera, const RenderOptions& options, const PartTree* tree, double tie);

  // Adds to `rgba` what of a hit reaches the start of the ray in the unit direction `direction`: the hit's own
  // opacity times `transmitted`, the part that what stands before it lets through. `point`, `direction`: eye space.
  void add(const RayHit& hit, const double point[3], const double direction[3], double transmitted, double rgba[4],
           int bounce = 0);
  // Unit normal of a hit in eye space, turned against the ray.
  void normal(const RayHit& hit, const double direction[3], double normal[3]) const;

  const Clipper* clipper() const { return secondary_ ? &secondary_->clipper() : nullptr; }

 private:
  void add_seen(const double origin[3], const double direction[3], int bounce, double rgba[4]);
  bool key_light_reaches(const double point[3], const double normal[3]);

  const Scene& scene_;
  const Camera& camera_;
  bool shadows_;
  double reflectance_;
  std::optional<SecondaryRays> secondary_;
};

}  // namespace nofacet
