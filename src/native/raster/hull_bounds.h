// Where a net lies on the screen and how near, from its control points.
#pragma once
#include <cmath>

#include "raster/key_plane.h"

namespace nofacet {

struct HullBounds {
  Interval x, y;     // pixels
  Interval key;      // depth key
  KeyPlane plane;    // within its error of the net
  double lean;       // how far the net leans, x by y ...
  Interval upright;  // ... and x - lean y

  // Where scan plane y may meet the net.
  Interval x_at(double level) const {
    const Interval leaning{upright.lo + lean * level, upright.hi + lean * level};
    return intersect(x, leaning);
  }
};

// Of what may be anywhere.
inline constexpr Interval kAnywhere{-INFINITY, INFINITY};
inline constexpr HullBounds kUnbounded{kAnywhere, kAnywhere, kAnywhere, {-INFINITY, 0.0, 0.0, 0.0}, 0.0, kAnywhere};

// x, y, key: ranges of the net's control points. All weights must be positive.
HullBounds hull_bounds(const Net& net, Interval x, Interval y, Interval key);

}  // namespace nofacet
