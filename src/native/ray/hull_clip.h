// Bezier clipping in two parameters: which part of a patch a ray, or a bundle of rays, can meet.
#pragma once
#include "bezier/net.h"
#include "ray/ray_patch.h"

namespace nofacet {

// A bundle of rays: all that meet the screen within (half_x, half_y) of (x, y). One ray has no width.
struct RayBundle {
  double x, y, half_x, half_y;
};

// The parts a and b of [0, 1] outside which no ray of the bundle meets the net; false if none meets it at all.
//
// Nishita, Sederberg, Kakimoto, "Ray tracing trimmed rational surface patches", SIGGRAPH 1990: the control points'
// distances D_ij from the line L_u through the ray, which runs like the patch in v, seen as points (i / n, D_ij): where
// their convex hull meets the axis. Departures: a bundle's distances are intervals, so its hull is thicker, and where
// L_u is not defined because the mean edge vanishes the other parameter's takes its place.
// `rounding`: how far the distances may be off, per unit of screen; the result is widened by it.
bool clip_net(const Net& net, const RayBundle& bundle, double rounding, Interval* a, Interval* b);

}  // namespace nofacet
