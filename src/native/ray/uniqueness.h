// The certificate that ends the clipping: over a whole net a ray meets the surface once or not at all, and Newton's
// method tells which.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// Let f be the map from [0, 1]^2 to the screen, A its Jacobian in the middle, and |A^-1 J - 1| <= q in the maximum norm
// for all Jacobians J over the net, from the convex hull of its differences. For q < 1 f is one-to-one: between two
// points f differs by a mean of Jacobians times their difference, which is not singular. A Newton step from
// any point of the square to the root r leaves an error of at most c |x - r|, c = 2 q / (1 - q); clamping to the square
// increases no error. For q < 1/5 it is c < 1/2, so the steps converge, and a step that ends further outside the square
// than c / (1 - c) of its length proves that there is no root inside.
struct Uniqueness {
  static constexpr double kLimit = 0.18;

  double q;           // infinity if A is singular or it is soon seen to be above the limit
  double x, y;        // f in the middle, pixels
  double a[2], b[2];  // A^-1: a parameter's change for a unit of x and y

  // Weights of all control points must be positive.
  explicit Uniqueness(const Net& net);
  bool holds() const { return q <= kLimit; }

  // How far outside a step of length 1 proves a miss.
  double miss() const {
    const double c = 2.0 * q / (1.0 - q);
    return c / (1.0 - c);
  }
};

// Second-order terms of the inverse: a = 1/2 + a' - (aa a'^2 + ab a' b' + bb b'^2), with (a', b') the linear terms.
struct InverseCurvature {
  double a[3], b[3];
  InverseCurvature(const Net& net, const Uniqueness& linear);
};

}  // namespace nofacet
