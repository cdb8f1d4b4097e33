// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bezier/centred_net.cpp"
#include "bezier/centred_net.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// out[k] = sum over i of power[k * (count) + i] (in[i] - centre w_i), for `count` points `stride` numbers apart.
HWY_INLINE void convert_line(const double* in, int count, std::size_t stride, const double* power, const double* centre,
                             double* out) {
  const hn::CappedTag<double, 4> d;
  for (std::size_t part = 0; part < 4; part += hn::Lanes(d)) {
    const auto shift = hn::LoadU(d, centre + part);
    for (int k = 0; k < count; ++k) {
      auto sum = hn::Zero(d);
      for (int i = 0; i < count; ++i) {
        const double* p = in + i * stride;
        const auto shifted = hn::NegMulAdd(shift, hn::Set(d, p[kW]), hn::LoadU(d, p + part));
        sum = hn::MulAdd(hn::Set(d, power[k * count + i]), shifted, sum);
      }
      hn::StoreU(sum, d, out + k * stride + part);
    }
  }
}

// Along b, then along a. `rows` and `out` have room for the net.
void Convert(const Net& net, const double* in_a, const double* in_b, const double* centre, double* rows, double* out) {
  const double none[4] = {0, 0, 0, 0};
  const std::size_t row = 4 * std::size_t(net.m + 1);
  for (int i = 0; i <= net.n; ++i) {
    convert_line(net.points + i * row, net.m + 1, 4, in_b, centre, rows + i * row);
  }
  for (int j = 0; j <= net.m; ++j) convert_line(rows + 4 * j, net.n + 1, row, in_a, none, out + 4 * j);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(Convert);

namespace {

// power[k * (n + 1) + i]: coefficient of (t - 1/2)^k in the Bernstein polynomial B_i^n. All are exact.
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

// The same as Convert where that would lose too many digits.
void convert_precisely(const Net& net, const Conversion& in_a, const Conversion& in_b, const double* centre,
                       double* out) {
  const int n = net.n, m = net.m;
  for (int c = 0; c < 4; ++c) {
    long double rows[kMaxDegree + 1][kMaxDegree + 1];
    for (int i = 0; i <= n; ++i) {
      for (int k = 0; k <= m; ++k) {
        rows[i][k] = 0.0L;
        for (int j = 0; j <= m; ++j) {
          const double* p = net.at(i, j);
          rows[i][k] += in_b.power[k * (m + 1) + j] * (p[c] - (long double)(centre[c]) * p[kW]);
        }
      }
    }
    for (int k = 0; k <= n; ++k) {
      for (int j = 0; j <= m; ++j) {
        long double sum = 0.0L;
        for (int i = 0; i <= n; ++i) sum += in_a.power[k * (n + 1) + i] * rows[i][j];
        out[4 * (k * (m + 1) + j) + c] = double(sum);
      }
    }
  }
}

// How far the terms of some coefficients move points of a net, at most.
class Rest {
 public:
  Rest(const CentredNet& net, const double scale[4]) : net_(net) { std::copy_n(scale, 4, scale_); }

  double term(int i, int j) const {
    const double* p = net_.points + 4 * (i * (net_.m + 1) + j);
    double worst = 0.0;
    for (const int c : {kX, kY, kZ})
      worst = std::max(worst, scale_[c] * std::fabs(p[c]) + scale_[kW] * std::fabs(p[kW]));
    return worst * kHalves[i + j];
  }
  // Of the powers n of a, where those of b go up to m; of the powers m of b, where those of a go up to n.
  double row(int n, int m) const {
    double sum = 0.0;
    for (int j = 0; j <= m; ++j) sum += term(n, j);
    return sum;
  }
  double column(int n, int m) const {
    double sum = 0.0;
    for (int i = 0; i <= n; ++i) sum += term(i, m);
    return sum;
  }

 private:
  static constexpr auto kHalves = [] {  // powers of 1/2
    std::array<double, 2 * kMaxDegree + 1> halves{1.0};
    for (std::size_t k = 1; k < halves.size(); ++k) halves[k] = 0.5 * halves[k - 1];
    return halves;
  }();

  const CentredNet& net_;
  double scale_[4];
};

// Lowers the degrees as far as the rest stays below kCentredRest.
void drop_high_powers(CentredNet& net, const double scale[4], double* points) {
  const Rest rest(net, scale);
  double left = kCentredRest;
  int n = net.n, m = net.m;
  for (bool dropped = true; dropped;) {
    dropped = false;
    if (const double r = n > 1 ? rest.row(n, m) : INFINITY; r <= left) left -= r, --n, dropped = true;
    if (const double r = m > 1 ? rest.column(n, m) : INFINITY; r <= left) left -= r, --m, dropped = true;
  }
  if (n == net.n && m == net.m) return;
  for (int i = 0; i <= n; ++i) {
    std::copy_n(points + 4 * i * (net.m + 1), 4 * (m + 1), points + 4 * i * (m + 1));
  }
  net.n = n, net.m = m;
}

}  // namespace

CentredNet centre_net(const Net& net, double key_scale, double* out) {
  const ComponentRanges range = ratio_ranges(net);
  const double centre[4] = {range[kX].mid(), range[kY].mid(), 0.0, range[kZ].mid()};
  const double reach = 0.5 * std::max(range[kX].width(), range[kY].width());
  const Conversion &in_a = conversion(net.n), &in_b = conversion(net.m);
  CentredNet result{net.n, net.m, out, centre[kX], centre[kY], centre[kZ], 0.0};
  result.error = std::ldexp(reach, net.n + net.m - 52);
  // Beyond that the conversion takes more than double precision.
  if (result.error < kCentredError) {
    double rows[4 * (kMaxDegree + 1) * (kMaxDegree + 1)];
    HWY_DYNAMIC_DISPATCH(Convert)(net, in_a.power.data(), in_b.power.data(), centre, rows, out);
  } else {
    convert_precisely(net, in_a, in_b, centre, out);
    result.error = std::ldexp(reach, net.n + net.m - std::numeric_limits<long double>::digits);
  }
  double least_weight = INFINITY;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4)
    least_weight = std::min(least_weight, p[kW]);
  const double scale[4] = {1.0 / least_weight, 1.0 / least_weight,
                           std::max(reach, 0.5 * range[kZ].width() * key_scale) / least_weight,
                           key_scale / least_weight};
  drop_high_powers(result, scale, out);
  return result;
}

}  // namespace nofacet
#endif
