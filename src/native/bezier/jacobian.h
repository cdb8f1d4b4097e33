// The screen Jacobian of a patch as a Bernstein form of its own, and how it turns along scan planes.
#pragma once
#include "bezier/net.h"

namespace nofacet {

// Degrees (n, m) up to which these forms are small enough to be carried along.
inline constexpr int kMaxJacobianDegree = 3;

// Scalar Bernstein form: coefficients[i * (m + 1) + j].
struct Grid {
  int n = 0, m = 0;
  double* coefficients = nullptr;

  std::size_t size() const { return std::size_t(n + 1) * (m + 1); }
  // Of the coefficients, and so of the form.
  Interval range() const { return value_range(coefficients, size()); }
};

// Degrees of the two forms below. With weights that differ, J stands for its numerator det(P, P_a, P_b) of
// homogeneous points (X, Y, W), which is J W^3; the derivatives of y stand for theirs, y_a W^2 and y_b W^2.
struct JacobianDegrees {
  int j_n, j_m, turn_n, turn_m;

  JacobianDegrees(int n, int m, bool rational)
      : j_n(rational ? 3 * n - 1 : 2 * n - 1),
        j_m(rational ? 3 * m - 1 : 2 * m - 1),
        turn_n(j_n - 1 + (rational ? 2 * n : n)),
        turn_m(j_m + (rational ? 2 * m - 1 : m - 1)) {}
};

// Coefficients of J's form and of its turn's, at most.
inline constexpr int kMaxJacobianSize = 9 * kMaxJacobianDegree * kMaxJacobianDegree;
inline constexpr int kMaxTurnSize = (5 * kMaxJacobianDegree - 1) * (5 * kMaxJacobianDegree - 1);

// Writes J, of y and `along` (kX; with kZ the depth key takes the place of x); `out` has the degrees for it. Returns
// the size of its terms: its rounding errors are within about 1e-15 of that.
double jacobian_form(const Net& net, bool rational, Component along, Grid out);
// Writes J_a y_b - J_b y_a, which has the sign of dJ along the curves y = const, once y_b is positive. Returns the size
// of its terms, as above.
double turn_form(const Net& net, bool rational, const Grid& jacobian, Grid out);

// The same form with the degrees of `out`, which are no lower (degree elevation).
void elevate(const Grid& form, Grid out);

}  // namespace nofacet
