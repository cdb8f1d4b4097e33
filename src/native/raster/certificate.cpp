#include "raster/certificate.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

bool clearly_one_signed(Interval value, double terms) { return value.mignitude() > kRoundingMargin * terms; }

bool grows_with_b(const QuotientBounds& y) { return clearly_one_signed(y.fb, y.fa.magnitude() + y.fb.magnitude()); }

// Bounds of the screen Jacobian J = x_a y_b - x_b y_a and of its derivatives. J does not change when the screen is
// rotated, its bounds do.
struct JacobianBounds {
  Interval j, ja, jb;
  double terms;

  JacobianBounds(const QuotientBounds& x, const QuotientBounds& y)
      : j(x.fa * y.fb - x.fb * y.fa),
        ja(x.faa * y.fb + x.fa * y.fab - x.fab * y.fa - x.fb * y.faa),
        jb(x.fab * y.fb + x.fa * y.fbb - x.fbb * y.fa - x.fb * y.fab),
        terms(x.fa.magnitude() * y.fb.magnitude() + x.fb.magnitude() * y.fa.magnitude()) {}
  JacobianBounds(Interval value, Interval by_a, Interval by_b, double size)
      : j(value), ja(by_a), jb(by_b), terms(size) {}

  JacobianBounds transposed() const { return {-j, -jb, -ja, terms}; }
};

struct CutBounds {
  CutKind kind = CutKind::uncertain;
  double slope = 0.0;  // largest |db/da|
};

// With b as the dependent parameter. On the cut db/da = m = -y_a / y_b and dx/da = J / y_b, so x turns where J changes
// sign, and at most once if dJ/da = J_a + m J_b has one sign.
CutBounds bound_cut(const QuotientBounds& y, const JacobianBounds& jacobian) {
  CutBounds cut;
  if (!grows_with_b(y)) return cut;
  const Interval m = -(y.fa / y.fb);
  cut.slope = m.magnitude();
  if (clearly_one_signed(jacobian.j, jacobian.terms)) {
    cut.kind = CutKind::regular;
  } else if (jacobian.j.magnitude() < kSliverPixels * y.fb.mignitude()) {
    cut.kind = CutKind::sliver;
  } else if (clearly_one_signed(jacobian.ja + m * jacobian.jb, jacobian.ja.magnitude())) {
    cut.kind = CutKind::fold;
  }
  return cut;
}

Certificate best_cut(const NetBounds& bounds, const JacobianBounds& jacobian) {
  const CutBounds straight = bound_cut(bounds.y, jacobian);
  const CutBounds turned = bound_cut(transposed_bounds(bounds.y), jacobian.transposed());
  if (straight.kind != turned.kind)
    return straight.kind < turned.kind ? Certificate{straight.kind, false} : Certificate{turned.kind, true};
  return {straight.kind, turned.slope < straight.slope};
}

// The net in a screen whose axes run along and across the line from its first to its farthest corner. A piece seen
// nearly edge-on is a thin strip; across it all bounds are small, while along the old axes x and y vary together and
// their intervals cannot know it.
NetBounds rotated_bounds(const Net& net, double* scratch) {
  const double* origin = net.at(0, 0);
  double dx = 1.0, dy = 0.0, longest = 0.0;
  for (const double* corner : {net.at(net.n, 0), net.at(0, net.m), net.at(net.n, net.m)}) {
    const double x = corner[kX] / corner[kW] - origin[kX] / origin[kW];
    const double y = corner[kY] / corner[kW] - origin[kY] / origin[kW];
    const double length = std::hypot(x, y);
    if (length > longest) longest = length, dx = x / length, dy = y / length;
  }
  const std::size_t size = net.size();
  for (std::size_t k = 0; k < size; k += 4) {
    // Relative to the corner, so that rotating distant coordinates loses nothing.
    const double w = net.points[k + kW];
    const double x = net.points[k + kX] - origin[kX] / origin[kW] * w;
    const double y = net.points[k + kY] - origin[kY] / origin[kW] * w;
    scratch[k + kX] = dx * x + dy * y;
    scratch[k + kY] = dx * y - dy * x;
    scratch[k + kW] = w;
    scratch[k + kZ] = net.points[k + kZ];
  }
  return NetBounds({net.n, net.m, scratch});
}

// How much the factors that J is made of change along a: what its interval is wide for, whether or not J itself
// changes.
double factor_change(const QuotientBounds& x, const QuotientBounds& y) {
  return x.faa.magnitude() * y.fb.magnitude() + x.fa.magnitude() * y.fab.magnitude() +
         x.fab.magnitude() * y.fa.magnitude() + x.fb.magnitude() * y.faa.magnitude();
}

}  // namespace

Certificate certify_cut(const Net& net, const NetBounds& bounds) {
  const Certificate plain = best_cut(bounds, JacobianBounds(bounds.x, bounds.y));
  if (plain.kind != CutKind::uncertain) return plain;
  double scratch[4 * (kMaxDegree + 1) * (kMaxDegree + 1)];
  const NetBounds rotated = rotated_bounds(net, scratch);
  Certificate certificate = best_cut(bounds, JacobianBounds(rotated.x, rotated.y));
  certificate.graph = grows_with_b(bounds.y) || grows_with_b(transposed_bounds(bounds.y));
  if (certificate.kind == CutKind::uncertain && certificate.graph) {
    // The cut is a graph and only the sign of J is open: halve what J's interval is wide for.
    const double by_a = factor_change(rotated.x, rotated.y);
    const double by_b = factor_change(transposed_bounds(rotated.x), transposed_bounds(rotated.y));
    certificate.halve = by_a >= by_b ? Halve::a : Halve::b;
  }
  return certificate;
}

namespace {

// How much the form changes along a, and along b.
double variation(const Grid& grid, bool along_a) {
  const int row = grid.m + 1, stride = along_a ? row : 1;
  double largest = 0.0;
  for (int i = 0; i <= (along_a ? grid.n - 1 : grid.n); ++i) {
    for (int j = 0; j <= (along_a ? grid.m : grid.m - 1); ++j) {
      const double* c = grid.coefficients + i * row + j;
      largest = std::max(largest, std::fabs(c[stride] - c[0]));
    }
  }
  return largest * (along_a ? grid.n : grid.m);
}

// The c for which key_jacobian - c jacobian has one sign all over, though the Jacobian has two; empty if there are
// none.
Interval steady_shears(const Grid& key_jacobian, const Grid& jacobian) {
  for (const double sign : {1.0, -1.0}) {
    Interval c{-INFINITY, INFINITY};
    for (std::size_t k = 0; k < jacobian.size() && c.lo < c.hi; ++k) {
      const double j = sign * jacobian.coefficients[k], bound = key_jacobian.coefficients[k] / jacobian.coefficients[k];
      if (j > 0) c.hi = std::min(c.hi, bound);
      if (j < 0) c.lo = std::max(c.lo, bound);
      if (j == 0 && !(sign * key_jacobian.coefficients[k] > 0)) c.hi = -INFINITY;
    }
    // Well inside of it none of the differences is near zero.
    if (c.lo < c.hi) return {c.lo + 0.25 * c.width(), c.hi - 0.25 * c.width()};
  }
  return Interval::empty();
}

// Whether J vanishes at most once along every cut: its turn K has one sign wherever J = 0. That is so if K + c J has
// one sign all over, for whatever c: c J adds nothing where J = 0.
bool vanishes_once(const Grid& jacobian, const Grid& turn, const CarriedForms& scales) {
  if (clearly_one_signed(turn.range(), scales.turn_terms)) return true;
  double elevated[kMaxTurnSize], sum[kMaxTurnSize];
  const Grid j{turn.n, turn.m, elevated};
  elevate(jacobian, j);
  const double* k = turn.coefficients;
  for (const double sign : {1.0, -1.0}) {
    // Every coefficient of sign (K + c J) that is to be positive bounds c from one side.
    Interval c{-INFINITY, INFINITY};
    for (std::size_t i = 0; i < turn.size() && c.lo < c.hi; ++i) {
      const double bound = -k[i] / elevated[i];
      if (sign * elevated[i] > 0) c.lo = std::max(c.lo, bound);
      if (sign * elevated[i] < 0) c.hi = std::min(c.hi, bound);
    }
    if (!(c.lo < c.hi)) continue;
    // J has both signs, so both bounds are finite but for underflow.
    const double best = c.mid();
    if (!std::isfinite(best)) continue;
    for (std::size_t i = 0; i < turn.size(); ++i) sum[i] = k[i] + best * elevated[i];
    if (clearly_one_signed(value_range(sum, turn.size()),
                           scales.turn_terms + std::fabs(best) * scales.jacobian_terms)) {
      return true;
    }
  }
  return false;
}

}  // namespace

Certificate certify_cut(const QuotientBounds& y, const Grid& jacobian, const Grid& turn, const Grid& key_jacobian,
                        const CarriedForms& scales) {
  const QuotientBounds turned = transposed_bounds(y);
  const bool straight = grows_with_b(y), across = grows_with_b(turned);
  if (!straight && !across) return {};
  Certificate certificate;
  certificate.graph = true;
  // The flatter graph, if both are.
  const auto slope = [](const QuotientBounds& q) { return q.fa.magnitude() / q.fb.mignitude(); };
  certificate.transposed = straight && across ? slope(turned) < slope(y) : across;
  // J is at most W^3 steepness times dx/da along a cut. What it reaches to the other side of zero, if only by rounding
  // on a border that is a silhouette, moves x back by no more than is negligible.
  const Interval j = jacobian.range();
  const double steepness = (certificate.transposed ? turned : y).fb.mignitude();
  const double pixel = steepness * scales.weight * scales.weight * scales.weight;
  if (j.magnitude() < kSliverPixels * pixel) {
    certificate.kind = CutKind::sliver;
  } else if (j.lo > -kNegligiblePixels * pixel || j.hi < kNegligiblePixels * pixel) {
    certificate.kind = CutKind::regular;
  } else if (turn.coefficients && vanishes_once(jacobian, turn, scales)) {
    certificate.kind = CutKind::fold;
    if (key_jacobian.coefficients) certificate.shears = steady_shears(key_jacobian, jacobian);
  }
  if (certificate.kind == CutKind::uncertain ||
      (certificate.kind == CutKind::fold && !(certificate.shears.lo <= certificate.shears.hi))) {
    certificate.halve = variation(jacobian, true) >= variation(jacobian, false) ? Halve::a : Halve::b;
  }
  return certificate;
}

}  // namespace nofacet
