// Products of bivariate Bernstein forms.
#pragma once

namespace nofacet {

// Forms in scaled Bernstein coefficients, c_ij C(n, i) C(m, j), in which products are plain convolutions: c_ij stands
// at [i * kScaledStride + j], and no degree reaches the stride.
inline constexpr int kScaledStride = 16;

// out += sign f g; f has the degrees (f_n, f_m), g (g_n, g_m).
void add_scaled_product(double sign, const double* f, int f_n, int f_m, const double* g, int g_n, int g_m, double* out);

}  // namespace nofacet
