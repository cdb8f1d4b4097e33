// Every patch of the scene for rays that start anywhere: shadow rays and mirrored rays.
#pragma once
#include <vector>

#include "arena.h"
#include "camera.h"
#include "ray/clipper.h"
#include "ray/ray_patch.h"
#include "scene.h"

namespace nofacet {

// A hierarchy of boxes over parts of patches, in eye space (right, up, forward), also of what is off screen.
//
// Patches are halved until they are nearly flat, so that boxes fit well. The same Bezier clipping finds the roots: a
// ray is the intersection of two planes, and seen along the ray a patch is a net in which the ray is the origin.
// Memory: 32 bytes a control point for each placed patch and each part (at most kMaxParts a patch), and 200 bytes more.
class PartTree {
 public:
  static constexpr int kMaxParts = 64;

  PartTree(const Scene& scene, const Camera& camera);

  struct Box {
    double lo[3], hi[3];
    void include(const double* point);
    void include(const Box& box);
  };
  struct Part {
    Net net;        // eye space: right, up, forward, weight
    PatchBox box;   // of the patch
    int32_t patch;  // index
    Box bounds;
  };
  // Inner nodes have two children, the first of which follows the node; leaves hold parts [first, first + count).
  struct Node {
    Box bounds;
    int32_t first;  // of an inner node: the second child
    int32_t count;  // 0: inner node
  };

  const std::vector<RayPatch>& patches() const { return patches_; }  // nets in eye space
  const std::vector<Part>& parts() const { return parts_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  // Largest coordinate, and the largest extent.
  double magnitude() const { return magnitude_; }
  double extent() const { return extent_; }

 private:
  void add_parts(const Net& net, const PatchBox& box, int32_t patch, int halvings);
  void build(int32_t first, int32_t count);

  std::vector<RayPatch> patches_;
  std::vector<Part> parts_;
  std::vector<Node> nodes_;
  Arena<double> nets_;
  double magnitude_ = 0.0, extent_ = 0.0;
};

}  // namespace nofacet
