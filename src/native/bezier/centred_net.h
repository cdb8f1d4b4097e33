// A net in powers of a - 1/2 and b - 1/2, for fast evaluation.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// points[(i * (m + 1) + j) * 4 + component]: coefficient of (a - 1/2)^i (b - 1/2)^j of X - x W, Y - y W, W and
// Z - key W, where (x, y, key) is the centre: what is subtracted costs no digits later.
struct CentredNet {
  int n, m;
  const double* points;
  double x, y, key;
  // The net's rounding errors in x and y are within about this (in their units): 2^(n + m) units in the last place of
  // the distance from the centre, the sum of the conversion's coefficients.
  double error;
};

// Highest powers that together move no point of the net by more than kCentredRest, in x, y, and the key times
// `key_scale`, are left out. `out` has room for the net; all weights must be positive.
inline constexpr double kCentredRest = 1e-12;
// With an error below this a centred net is as good as the net itself, in pixels.
inline constexpr double kCentredError = 2e-9;
CentredNet centre_net(const Net& net, double key_scale, double* out);

}  // namespace nofacet
