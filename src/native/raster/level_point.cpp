#include "raster/level_point.h"

#include <cmath>

namespace nofacet {
namespace {

// y = Y / W and its derivatives by a and b.
struct SecondOrder {
  double y, a, b, aa, ab, bb;
};

// The second derivatives of the Bernstein polynomials of degree n.
void bernstein_bend(int n, double t, double* bend) {
  double lower[kMaxDegree + 1] = {0.0};
  if (n > 1) bernstein_basis(n - 2, t, lower);
  const double scale = double(n) * (n - 1);
  for (int i = 0; i <= n; ++i) {
    const double below = i >= 2 ? lower[i - 2] : 0.0, same = i >= 1 && i < n ? lower[i - 1] : 0.0;
    bend[i] = scale * (below - 2.0 * same + (i <= n - 2 ? lower[i] : 0.0));
  }
}

SecondOrder second_order(const Net& net, double a, double b) {
  double in_a[kMaxDegree + 1], by_a[kMaxDegree + 1], by_aa[kMaxDegree + 1];
  double in_b[kMaxDegree + 1], by_b[kMaxDegree + 1], by_bb[kMaxDegree + 1];
  bernstein_basis(net.n, a, in_a, by_a);
  bernstein_basis(net.m, b, in_b, by_b);
  bernstein_bend(net.n, a, by_aa);
  bernstein_bend(net.m, b, by_bb);
  SecondOrder numerator{}, weight{};
  const auto add = [](SecondOrder& sum, const double along_a[3], double value, double slope, double bend) {
    sum.y += along_a[0] * value, sum.a += along_a[1] * value, sum.aa += along_a[2] * value;
    sum.b += along_a[0] * slope, sum.ab += along_a[1] * slope, sum.bb += along_a[0] * bend;
  };
  const double* p = net.points;
  for (int i = 0; i <= net.n; ++i) {
    double row[3] = {0, 0, 0}, row_weight[3] = {0, 0, 0};
    for (int j = 0; j <= net.m; ++j, p += 4) {
      row[0] += in_b[j] * p[kY], row[1] += by_b[j] * p[kY], row[2] += by_bb[j] * p[kY];
      row_weight[0] += in_b[j] * p[kW], row_weight[1] += by_b[j] * p[kW], row_weight[2] += by_bb[j] * p[kW];
    }
    const double along_a[3] = {in_a[i], by_a[i], by_aa[i]};
    add(numerator, along_a, row[0], row[1], row[2]);
    add(weight, along_a, row_weight[0], row_weight[1], row_weight[2]);
  }
  SecondOrder q;
  const double r = 1.0 / weight.y;
  q.y = numerator.y * r;
  q.a = (numerator.a - q.y * weight.a) * r, q.b = (numerator.b - q.y * weight.b) * r;
  q.aa = (numerator.aa - 2.0 * q.a * weight.a - q.y * weight.aa) * r;
  q.ab = (numerator.ab - q.a * weight.b - q.b * weight.a - q.y * weight.ab) * r;
  q.bb = (numerator.bb - 2.0 * q.b * weight.b - q.y * weight.bb) * r;
  return q;
}

// By how much the control points of a parabola around its vertex lie beyond it, in parts of its height.
double overshoot(int degree) { return degree > 2 ? 1.0 / 3.0 : 1.0; }

}  // namespace

std::optional<ParameterBox> find_level_box(const Net& net, const ScanPlanes& planes) {
  constexpr int kMaxNewton = 8;
  constexpr double kLastStep = 1e-3;  // of the net: a box needs no exact middle
  constexpr double kShare = 0.8;      // of the room between the planes
  double a = 0.5, b = 0.5;
  for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
    const SecondOrder q = second_order(net, a, b);
    const double determinant = q.aa * q.bb - q.ab * q.ab;
    const double da = (q.ab * q.b - q.bb * q.a) / determinant, db = (q.ab * q.a - q.aa * q.b) / determinant;
    a += da, b += db;
    if (!(a >= 0.0 && a <= 1.0 && b >= 0.0 && b <= 1.0)) return std::nullopt;
    if (std::fabs(da) > kLastStep || std::fabs(db) > kLastStep) continue;
    const Interval gap = planes.gap(q.y);
    double below = q.y - gap.lo, above = gap.hi - q.y;
    if (determinant > 0) {  // a highest or lowest point: only control points lie beyond it
      double& beyond = q.aa < 0 ? above : below;
      beyond /= std::max(overshoot(net.n), overshoot(net.m));
    }
    // |y - q.y| <= (|aa| da^2 + 2 |ab da db| + |bb| db^2) / 2 with da = r / sqrt|aa|, db = r / sqrt|bb|.
    const double root_a = std::sqrt(std::fabs(q.aa)), root_b = std::sqrt(std::fabs(q.bb));
    const double r = std::sqrt(kShare * std::min(below, above) / (1.0 + std::fabs(q.ab) / (root_a * root_b)));
    const double reach_a = r / root_a, reach_b = r / root_b;
    if (!(reach_a > kLastStep && reach_b > kLastStep)) return std::nullopt;
    const ParameterBox box{{std::max(0.0, a - reach_a), std::min(1.0, a + reach_a)},
                           {std::max(0.0, b - reach_b), std::min(1.0, b + reach_b)}};
    if (box.a.width() == 1.0 && box.b.width() == 1.0) return std::nullopt;
    return box;
  }
  return std::nullopt;
}

}  // namespace nofacet
