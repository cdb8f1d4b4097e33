// Finds every point in which rays meet a patch.
#pragma once
#include <vector>

#include "camera.h"
#include "ray/hull_clip.h"
#include "ray/ray_patch.h"
#include "ray/solve_rays.h"

namespace nofacet {

// Takes the points that rays meet.
class HitSink {
 public:
  // Whether nothing at this depth or beyond is wanted of any ray.
  virtual bool hidden(double nearest) const = 0;
  // For each ray of the grid the depth beyond which nothing is wanted, or null.
  virtual const double* farthest() const = 0;
  // `region`: of which the points are still to be tested; null: they are inside.
  virtual void add(const RayPatch& patch, const Region* region, const SolvedRays& solved) = 0;

 protected:
  ~HitSink() = default;
};

// Bezier clipping of patches against bundles of rays, down to single rays where it takes that.
//
// Each turn of the loop drops the rays that the control points' hull misses, drops the part of the patch that no ray
// meets (hull_clip.h), and looks whether the rest is certified (uniqueness.h). A certified part is solved for all
// rays together by Newton's method. Where clipping stalls, several roots may be there: the part is halved, and few
// rays go on one by one, for which clipping is sharper. What is still not certified when it is narrower on the screen
// than kNegligible, or than some rounding, is taken for a point that the ray meets if it is small both ways (a pole),
// and dropped if it is not, for it bounds no area (a silhouette, a patch seen edge-on). One per thread. Memory: three
// nets of the patch for each halving, at most kMaxDepth of them.
class Clipper {
 public:
  // The rays to come. `camera`: of the normals; null: none wanted.
  void begin(const RayGrid& grid, const Camera* camera) {
    grid_ = grid;
    camera_ = camera;
  }
  // Hands every hit of the rays of `rect` on the patch to `sink`.
  void trace(const RayPatch& patch, const RayRect& rect, HitSink& sink);
  // The same where only the part `box` of the patch is looked at, whose net is `net`.
  void trace_part(const RayPatch& patch, const Net& net, const PatchBox& box, const RayRect& rect, HitSink& sink);

  int64_t leaves() const { return leaves_; }
  // Parts of patches or rays that were given up. 0 in a sound frame.
  int64_t unresolved() const { return unresolved_; }

 private:
  // Pixels; well below the shift of the samples (raster/scan_planes.h), by which a ray may miss a pole.
  static constexpr double kNegligible = 1e-10;
  static constexpr int kMaxDepth = 100;
  static constexpr int kMaxNodes = 1 << 20;  // for one patch and one bundle

  struct Part {
    Net net;
    PatchBox box;
    const Region* region;  // null: certainly inside
  };

  void visit(Part part, RayRect rect, int depth);
  static void clip(Part& part, Interval a, Interval b, double* points);
  bool outside_region(Part& part) const;
  void solve(const Part& part, const RayRect& rect, const Uniqueness& certificate);
  bool visit_single_rays(const Part& part, const RayRect& rect, double negligible, int depth);
  void add_point(const Part& part, const RayRect& ray);
  void split(const Part& part, const RayRect& rect, int depth);
  double* stored(int depth, int which);

  RayGrid grid_{};
  const Camera* camera_ = nullptr;
  const RayPatch* patch_ = nullptr;
  HitSink* sink_ = nullptr;
  std::vector<std::vector<double>> stack_;
  SolvedRays solved_;
  int64_t leaves_ = 0, unresolved_ = 0;
  int nodes_ = 0;
};

}  // namespace nofacet
