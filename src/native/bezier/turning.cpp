#include "bezier/turning.h"

#include <algorithm>

namespace nofacet {
namespace {

// C(n, k) for k = 0 .. n; exact to rounding far beyond any degree here.
void binomials(int n, double* out) {
  out[0] = 1.0;
  for (int k = 0; k < n; ++k) out[k + 1] = out[k] * (n - k) / (k + 1);
}

}  // namespace

int turning_polynomial(const double* points, std::size_t stride, int f, int w, int degree, double* out) {
  const int n = degree, total = 2 * n - 1;
  const auto at = [&](int i, int c) { return points[i * stride + c]; };
  bool polynomial = true;
  for (int i = 1; i <= n; ++i) polynomial &= at(i, w) == at(0, w);
  if (polynomial) {
    for (int i = 0; i < n; ++i) out[i] = at(i + 1, f) - at(i, f);
    return n - 1;
  }
  // Coefficients times binomials multiply like powers.
  double below[kMaxDegree + 1], own[kMaxDegree + 1], all[kMaxPolynomial + 1];
  binomials(n - 1, below), binomials(n, own), binomials(total, all);
  double scaled_f[kMaxDegree + 1], scaled_w[kMaxDegree + 1];
  for (int j = 0; j <= n; ++j) scaled_f[j] = own[j] * at(j, f), scaled_w[j] = own[j] * at(j, w);
  std::fill(out, out + total + 1, 0.0);
  for (int i = 0; i < n; ++i) {
    const double df = below[i] * (at(i + 1, f) - at(i, f)), dw = below[i] * (at(i + 1, w) - at(i, w));
    for (int j = 0; j <= n; ++j) out[i + j] += df * scaled_w[j] - scaled_f[j] * dw;
  }
  for (int k = 0; k <= total; ++k) out[k] /= all[k];
  return total;
}

}  // namespace nofacet
