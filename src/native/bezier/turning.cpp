#include "bezier/turning.h"

#include <algorithm>

namespace nofacet {
namespace {

double binomial(int n, int k) {
  double r = 1.0;
  for (int i = 1; i <= k; ++i) r = r * (n - k + i) / i;
  return r;
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
  std::fill(out, out + total + 1, 0.0);
  for (int i = 0; i < n; ++i) {
    const double df = at(i + 1, f) - at(i, f), dw = at(i + 1, w) - at(i, w);
    for (int j = 0; j <= n; ++j) {
      const double scale = binomial(n - 1, i) * binomial(n, j) / binomial(total, i + j);
      out[i + j] += scale * (df * at(j, w) - at(j, f) * dw);
    }
  }
  return total;
}

}  // namespace nofacet
