#include "raster/cut.h"

#include <algorithm>
#include <cmath>

#include "raster/screen_jet.h"

namespace nofacet {
namespace {

double jacobian_at(const Piece& piece, const CutPoint& point) {
  return ScreenJet(evaluate(piece.net, point.a, point.b)).jacobian();
}

CutPoint cut_point(const Piece& piece, double a, double b) {
  const Jet jet = evaluate(piece.net, a, b);
  return {a, b, jet.p[kX] / jet.p[kW], jet.p[kZ] / jet.p[kW]};
}

// Where x turns between two points of the cut whose Jacobians have opposite signs (Illinois' false position; an error e
// in a moves x by only its square).
CutPoint solve_fold(const Piece& piece, double y, const CutPoint& from, const CutPoint& to) {
  double fa = jacobian_at(piece, from), fb = jacobian_at(piece, to), a = from.a, b = to.a;
  int side = 0;
  CutPoint point = from;
  for (int iteration = 0; iteration < 100 && b - a > 1e-9; ++iteration) {
    double next = iteration % 8 == 7 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
    if (!(next > a && next < b)) next = 0.5 * (a + b);
    const double step = std::fabs(next - point.a);
    point = cut_point(piece, next, cut_at(piece, y, next, point.b));
    const double f = jacobian_at(piece, point);
    if (f == 0.0 || step < 1e-9) break;
    if ((f < 0) == (fa < 0)) {
      a = next, fa = f;
      if (side == -1) fb *= 0.5;
      side = -1;
    } else {
      b = next, fb = f;
      if (side == 1) fa *= 0.5;
      side = 1;
    }
  }
  point.fold = true;
  return point;
}

// The root of Y - y W on a border that the plane meets once.
double border_root(const double* points, std::size_t stride, int degree, double y) {
  double d[kMaxDegree + 1];
  for (int k = 0; k <= degree; ++k, points += stride) d[k] = points[kY] - y * points[kW];
  if ((d[0] < 0) == (d[degree] < 0)) return std::fabs(d[0]) <= std::fabs(d[degree]) ? 0.0 : 1.0;  // lost to rounding
  return bracketed_newton([&](double t, double* slope) { return bernstein_value(d, degree, t, slope); }, 0.0, 1.0,
                          d[0] < 0, d[0] / (d[0] - d[degree]));
}

}  // namespace

const std::vector<CutArc>& PieceCutter::cut(const Piece& piece, const double* y, int count) {
  arcs_.clear();
  if (count == 0) return arcs_;
  cut_at_borders(piece, y, count);
  if (piece.kind == CutKind::fold) split_at_folds(piece, y);
  return arcs_;
}

// Each border meets a plane at most once, so the four corners tell on which two borders a cut begins and ends. The
// planes come in order of y: at each end, a = 0 and a = 1, the cuts of the first ones lie on one of the borders b = 0
// and b = 1, those of the next ones on the end itself and the others' on the opposite border.
void PieceCutter::cut_at_borders(const Piece& piece, const double* y, int count) {
  const Net& net = piece.net;
  int reach[2], leave[2];  // the first plane whose cut ends on the end itself, and the first one after these
  for (const int end : {0, 1}) {
    const auto corner = [&](int j) {
      const double* p = net.at(end * net.n, j);
      return p[kY] / p[kW];
    };
    if (piece.rising) {
      leave[end] = int(std::upper_bound(y, y + count, corner(net.m)) - y);
      reach[end] = int(std::upper_bound(y, y + leave[end], corner(0)) - y);
    } else {
      reach[end] = int(std::lower_bound(y, y + count, corner(net.m)) - y);
      leave[end] = int(std::lower_bound(y + reach[end], y + count, corner(0)) - y);
    }
    borders_[2 + end].first = reach[end], borders_[2 + end].last = leave[end];
  }
  const double first_b = piece.rising ? 0.0 : 1.0;  // where the cuts of the first planes end
  Border &first_border = borders_[piece.rising ? 0 : 1], &last_border = borders_[piece.rising ? 1 : 0];
  first_border.first = std::min(reach[0], reach[1]), first_border.last = std::max(reach[0], reach[1]);
  last_border.first = std::min(leave[0], leave[1]), last_border.last = std::max(leave[0], leave[1]);

  const std::size_t row = 4 * std::size_t(net.m + 1);
  borders_[0].solve(net.at(0, 0), row, net.n, y);
  borders_[1].solve(net.at(0, net.m), row, net.n, y);
  borders_[2].solve(net.at(0, 0), 4, net.m, y);
  borders_[3].solve(net.at(net.n, 0), 4, net.m, y);
  const auto cut_end = [&](int plane, int end) -> CutPoint {
    if (plane >= reach[end] && plane < leave[end]) {
      const PlaneRoots& roots = borders_[2 + end].roots;
      const int k = plane - reach[end];
      return {double(end), roots.a[k], roots.x[k], roots.key[k]};
    }
    const bool first = plane < reach[end];
    const Border& border = first ? first_border : last_border;
    const int k = plane - border.first;
    return {border.roots.a[k], first ? first_b : 1.0 - first_b, border.roots.x[k], border.roots.key[k]};
  };
  for (int plane = first_border.first; plane < last_border.last; ++plane) {
    const CutPoint from = cut_end(plane, 0), to = cut_end(plane, 1);
    if (from.a < to.a) arcs_.push_back({plane, from, to});
  }
}

void PieceCutter::Border::solve(const double* points, std::size_t stride, int degree, const double* y) {
  if (first >= last) return;
  const std::size_t count = last - first;
  roots.resize(count);
  std::copy(y + first, y + last, roots.y.begin());
  roots.pad(count);
  border_roots(points, stride, degree, count, roots);
  for (std::size_t k = 0; k < count; ++k) {
    if (roots.step[k] < kRootStep) continue;
    const double t = border_root(points, stride, degree, roots.y[k]);
    double basis[kMaxDegree + 1], p[4] = {0, 0, 0, 0};
    bernstein_basis(degree, t, basis);
    for (int i = 0; i <= degree; ++i) {
      for (int c = 0; c < 4; ++c) p[c] += basis[i] * points[i * stride + c];
    }
    roots.a[k] = t, roots.x[k] = p[kX] / p[kW], roots.key[k] = p[kZ] / p[kW];
  }
}

// Cuts each arc whose Jacobian changes sign where it does.
void PieceCutter::split_at_folds(const Piece& piece, const double* y) {
  const std::size_t count = arcs_.size();
  if (count == 0) return;
  folds_.resize(count), to_folds_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const CutArc& arc = arcs_[k];
    folds_.y[k] = to_folds_.y[k] = y[arc.plane];
    folds_.a[k] = arc.from.a, folds_.b[k] = arc.from.b;
    to_folds_.a[k] = arc.to.a, to_folds_.b[k] = arc.to.b;
  }
  folds_.pad(count), to_folds_.pad(count);
  jacobians(piece.net, count, folds_);
  jacobians(piece.net, count, to_folds_);
  fold_arcs_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const double j0 = folds_.step[k], j1 = to_folds_.step[k];
    if ((j0 < 0) == (j1 < 0)) continue;
    const CutArc& arc = arcs_[k];
    const double t = j0 / (j0 - j1);
    const std::size_t next = fold_arcs_.size();  // at most k: what is read is not yet overwritten
    folds_.y[next] = y[arc.plane];
    folds_.a[next] = arc.from.a + t * (arc.to.a - arc.from.a);
    folds_.b[next] = arc.from.b + t * (arc.to.b - arc.from.b);
    fold_arcs_.push_back(int(k));
  }
  const std::size_t folds = fold_arcs_.size();
  if (folds == 0) return;
  folds_.pad(folds);
  fold_roots(piece.net, folds, folds_);
  split_.clear();
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const CutArc& arc = arcs_[k];
    if (next == folds || fold_arcs_[next] != int(k)) {
      split_.push_back(arc);
      continue;
    }
    // There is one fold between the ends, so what converged between them is it.
    const bool found = folds_.step[next] < kRootStep && folds_.a[next] > arc.from.a && folds_.a[next] < arc.to.a;
    const CutPoint fold = found ? CutPoint{folds_.a[next], folds_.b[next], folds_.x[next], folds_.key[next], true}
                                : solve_fold(piece, y[arc.plane], arc.from, arc.to);
    split_.push_back({arc.plane, arc.from, fold});
    split_.push_back({arc.plane, fold, arc.to});
    ++next;
  }
  arcs_.swap(split_);
}

double cut_at(const Piece& piece, double y, double a, double guess) {
  const Net& net = piece.net;
  double d[kMaxDegree + 1];
  if (a == 0.0 || a == 1.0) {  // a border of the piece: its own control points
    const double* p = net.at(a == 0.0 ? 0 : net.n, 0);
    for (int j = 0; j <= net.m; ++j, p += 4) d[j] = p[kY] - y * p[kW];
  } else {
    double basis[kMaxDegree + 1];
    bernstein_basis(net.n, a, basis);
    std::fill(d, d + net.m + 1, 0.0);
    const double* p = net.points;
    for (int i = 0; i <= net.n; ++i) {
      for (int j = 0; j <= net.m; ++j, p += 4) d[j] += basis[i] * (p[kY] - y * p[kW]);
    }
  }
  if ((d[0] < 0) == (d[net.m] < 0)) {  // an end of the cut, lost to rounding: the border it lies on
    return std::fabs(d[0]) <= std::fabs(d[net.m]) ? 0.0 : 1.0;
  }
  const double secant = d[0] / (d[0] - d[net.m]);
  if (net.m == 1) return secant;
  if (!(guess > 0.0 && guess < 1.0)) guess = secant;
  return bracketed_newton([&](double b, double* slope) { return bernstein_value(d, net.m, b, slope); }, 0.0, 1.0,
                          d[0] < 0, guess);
}

}  // namespace nofacet
