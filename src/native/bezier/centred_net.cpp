#include "bezier/centred_net.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nofacet {
namespace {

// power[k][i]: coefficient of (t - 1/2)^k in the Bernstein polynomial B_i^n.
struct Conversion {
  std::vector<double> power;
  int n = 0;

  explicit Conversion(int degree) : power(std::size_t(degree + 1) * (degree + 1)), n(degree) {
    // B_i^n = C(n, i) (1/2 + s)^i (1/2 - s)^(n - i), multiplied out factor by factor.
    double binomial = 1.0;
    for (int i = 0; i <= n; ++i) {
      std::array<double, kMaxDegree + 2> c{};
      c[0] = binomial;
      for (int factor = 0; factor < n; ++factor) {
        const double sign = factor < i ? 1.0 : -1.0;
        for (int k = factor + 1; k >= 0; --k) c[k] = 0.5 * c[k] + (k > 0 ? sign * c[k - 1] : 0.0);
      }
      for (int k = 0; k <= n; ++k) power[k * (n + 1) + i] = c[k];
      binomial = binomial * (n - i) / (i + 1);
    }
  }
};

const Conversion& conversion(int degree) {
  static const std::vector<Conversion> table = [] {
    std::vector<Conversion> all;
    for (int n = 0; n <= kMaxDegree; ++n) all.emplace_back(n);
    return all;
  }();
  return table[degree];
}

}  // namespace

CentredNet centre_net(const Net& net, std::vector<double>& storage) {
  const int n = net.n, m = net.m, row = 4 * (m + 1);
  const ComponentRanges range = ratio_ranges(net);
  const double centre[4] = {range[kX].mid(), range[kY].mid(), 0.0, range[kZ].mid()};
  storage.assign(2 * net.size(), 0.0);
  double *rows = storage.data() + net.size(), *out = storage.data();
  // Along b, then along a.
  const Conversion &in_b = conversion(m), &in_a = conversion(n);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) {
      const double* p = net.at(i, j);
      double shifted[4];
      for (int c = 0; c < 4; ++c) shifted[c] = p[c] - centre[c] * p[kW];
      shifted[kW] = p[kW];
      for (int k = 0; k <= m; ++k) {
        const double factor = in_b.power[k * (m + 1) + j];
        for (int c = 0; c < 4; ++c) rows[i * row + 4 * k + c] += factor * shifted[c];
      }
    }
  }
  for (int k = 0; k <= n; ++k) {
    for (int i = 0; i <= n; ++i) {
      const double factor = in_a.power[k * (n + 1) + i];
      for (int c = 0; c < row; ++c) out[k * row + c] += factor * rows[i * row + c];
    }
  }
  const double reach = 0.5 * std::max(range[kX].width(), range[kY].width());
  return {n, m, out, centre[kX], centre[kY], centre[kZ], std::ldexp(reach, n + m - 52)};
}

}  // namespace nofacet
