// A patch's homogeneous point with its derivatives up to the second order.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// The point and its partial derivatives by the patch parameters a and b; components as in the net.
struct SecondJet {
  double p[4], pa[4], pb[4], paa[4], pab[4], pbb[4];
};

SecondJet evaluate_second(const Net& net, double a, double b);

}  // namespace nofacet
