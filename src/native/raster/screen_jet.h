// Position and first derivatives on the screen, in pixels, and the depth key's.
#pragma once
#include "bezier/net.h"

namespace nofacet {

struct ScreenJet {
  double x, y, key, xa, xb, ya, yb, ka, kb;

  explicit ScreenJet(const Jet& jet) {
    const double r = 1.0 / jet.p[kW];
    x = jet.p[kX] * r;
    y = jet.p[kY] * r;
    key = jet.p[kZ] * r;
    xa = (jet.pa[kX] - x * jet.pa[kW]) * r;
    xb = (jet.pb[kX] - x * jet.pb[kW]) * r;
    ya = (jet.pa[kY] - y * jet.pa[kW]) * r;
    yb = (jet.pb[kY] - y * jet.pb[kW]) * r;
    ka = (jet.pa[kZ] - key * jet.pa[kW]) * r;
    kb = (jet.pb[kZ] - key * jet.pb[kW]) * r;
  }
  double jacobian() const { return xa * yb - xb * ya; }
  // dx/da along the curve y = const (b follows a).
  double x_along_cut() const { return xa - xb * ya / yb; }
};

}  // namespace nofacet
