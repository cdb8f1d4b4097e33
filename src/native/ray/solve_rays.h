// Newton's method for many rays at once on a certified part of a patch.
#pragma once
#include "camera.h"
#include "ray/ray_patch.h"
#include "ray/uniqueness.h"

namespace nofacet {

// A part of a patch whose certificate holds.
//
// Where the patch is halved is decided by the rays, so a ray may well meet the border between two leaves. Roots are
// accepted a little beyond the leaf's borders, further than they are in error, so that none falls between: it is then
// found in both, as one and the same point.
struct RayLeaf {
  static constexpr double kBeyond = 1e-9;  // in the leaf's parameters, besides twice their rounding

  // `part`: the net over `b`, of which `certificate` holds.
  RayLeaf(const RayPatch& p, const PatchBox& b, const Net& part, const Uniqueness& certificate);

  const RayPatch& patch;
  PatchBox box;
  Uniqueness unique;
  InverseCurvature curvature;
  double nearest;  // depth
  // In the leaf's parameters a and b: the rounding that comes of the coordinates', and how long the last step may be.
  double rounding[2], tolerance[2];

  // How far beyond the leaf's borders roots are accepted.
  double beyond() const { return kBeyond + 2.0 * std::max(rounding[0], rounding[1]); }
};

// The rays that hit a leaf. Normals are unit vectors in eye space, turned towards the eye, and zero where the
// derivatives give none.
struct SolvedRays {
  static constexpr int kCapacity = 256, kPadding = 64;

  int count = 0;
  int undecided = 0;                 // rays that neither converged nor were proved to miss; 0 while arithmetic is sound
  double ray[kCapacity + kPadding];  // index in the grid: j columns + i
  double s[kCapacity + kPadding], t[kCapacity + kPadding];        // of the patch, for the value
  double s_in[kCapacity + kPadding], t_in[kCapacity + kPadding];  // the same where membership is decided
  double depth[kCapacity + kPadding];
  double normal[3][kCapacity + kPadding];
};

// Solves the rays of `rect` (at most SolvedRays::kCapacity). `farthest`: rays whose value, at the ray's index, is less
// than the leaf's nearest depth are left out; null: none. `camera`: of the normals; null: none wanted.
// `farthest` must be readable for kPadding values beyond the last ray.
void solve_rays(const RayLeaf& leaf, const RayGrid& grid, const RayRect& rect, const double* farthest,
                const Camera* camera, SolvedRays& out);

}  // namespace nofacet
