// Planes on which the depth key is linear over the screen, near a piece of surface.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// key = at + by_x x + by_y y, to within +-error, all over a net.
struct KeyPlane {
  double at = 0.0, by_x = 0.0, by_y = 0.0, error = 0.0;

  double key(double x, double y) const { return at + by_x * x + by_y * y; }
};

// The plane through the mean directions of the net, with the hull's distance from it; `key`: the hull's range. If the
// net is too curved, or edge-on, a plane of constant key is better. All weights must be positive.
KeyPlane fit_key_plane(const Net& net, Interval key);

}  // namespace nofacet
