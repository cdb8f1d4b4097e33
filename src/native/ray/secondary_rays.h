// Rays that start on surfaces: towards the light, and mirrored.
#pragma once
#include <vector>

#include "ray/clipper.h"
#include "ray/part_tree.h"
#include "ray/tile_hits.h"

namespace nofacet {

// Traces single rays through a PartTree. One per thread.
//
// A ray meets the surface it starts on, and others that touch there, at its very origin. Those roots are told by
// geometry: the origin lies on the surface hit, that is within `tie` of its tangent plane at the hit, and `tie` is
// the distance below which two surfaces are one everywhere in this method. The origin itself is off its surface by no
// more than rounding (1e-12 of the coordinates), far less. A surface that the ray really meets again is passed over
// only where the ray touches it: at an angle below the root of tie / (2 radius), 1e-5 on a surface as large as the
// scene.
class SecondaryRays {
 public:
  SecondaryRays(const Scene& scene, const PartTree& tree, double tie) : scene_(scene), tree_(tree), tie_(tie) {}

  // Whether an opaque surface lies in the direction `direction` (a unit vector) from `origin`; all in eye space.
  bool blocked(const double origin[3], const double direction[3]);
  // The nearest hit in that direction; its `depth` is the distance and its normal is turned against the direction.
  // Null in `patch`: none.
  RayHit nearest(const double origin[3], const double direction[3]);

  const Clipper& clipper() const { return clipper_; }

 private:
  class Sink;

  // The frame of one ray: two planes through it, and itself.
  struct RayFrame {
    double origin[3], axes[3][3];
    RayFrame(const double o[3], const double direction[3]);
  };

  void trace(const RayFrame& frame, Sink& sink);
  void trace_part(const RayFrame& frame, const PartTree::Part& part, Sink& sink);
  bool project(const RayFrame& frame, const Net& net, std::vector<double>& out) const;

  const Scene& scene_;
  const PartTree& tree_;
  double tie_;
  Clipper clipper_;
  std::vector<double> part_points_, patch_points_;
  std::vector<int32_t> stack_;
};

}  // namespace nofacet
