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

// The homogeneous control points of a curve's parts over [0, t] and [t, 1] (de Casteljau), without gaps.
void split_curve(const double* points, std::size_t stride, int degree, double t, double* left, double* right) {
  double* work = right;
  for (int i = 0; i <= degree; ++i) std::copy(points + i * stride, points + i * stride + 4, work + 4 * i);
  for (int level = 0;; ++level) {
    std::copy(work, work + 4, left + 4 * level);
    if (level == degree) return;
    for (int i = 0; i < 4 * (degree - level); ++i) work[i] += t * (work[i + 4] - work[i]);
  }
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

// The cuts of a plane begin and end where it crosses the piece's borders: in order of a, every crossing enters or
// leaves.
void PieceCutter::cut_at_borders(const Piece& piece, const double* y, int count) {
  border_count_ = 0;
  cross_end(piece, 0, y, count);
  cross_side(piece, 0, y, count);
  cross_side(piece, 1, y, count);
  cross_end(piece, 1, y, count);
  points_.resize(border_count_);
  int plane = count, last = 0;
  for (std::size_t k = 0; k < border_count_; ++k) {
    plane = std::min(plane, borders_[k].first);
    last = std::max(last, borders_[k].last);
  }
  for (; plane < last; ++plane) {
    std::size_t found = 0;
    for (std::size_t k = 0; k < border_count_; ++k) {
      const Border& border = borders_[k];
      if (plane < border.first || plane >= border.last) continue;
      points_[found] = border.point(plane);
      for (std::size_t i = found++; i > 0 && points_[i].a < points_[i - 1].a; --i) {
        std::swap(points_[i], points_[i - 1]);
      }
    }
    for (std::size_t k = 1; k < found; k += 2) {
      if (points_[k - 1].a < points_[k].a) arcs_.push_back({plane, int32_t(k / 2), points_[k - 1], points_[k]});
    }
  }
}

PieceCutter::Border& PieceCutter::next_border() {
  if (border_count_ == borders_.size()) borders_.emplace_back();
  return borders_[border_count_++];
}

// The border a = end, along which y moves one way.
void PieceCutter::cross_end(const Piece& piece, int end, const double* y, int count) {
  Border& border = next_border();
  border.points = piece.net.at(end * piece.net.n, 0), border.stride = 4;
  border.a = end, border.da = 0.0, border.b = 0.0, border.db = 1.0;
  border.solve(piece.net.m, y, count);
}

// The border b = side, cut where y turns: neighbouring parts share the point there to the last digit.
void PieceCutter::cross_side(const Piece& piece, int side, const double* y, int count) {
  const Net& net = piece.net;
  const std::size_t row = 4 * std::size_t(net.m + 1), part_size = 4 * std::size_t(net.n + 1);
  const int turn_count = piece.turn_count[side];
  const double* turns = piece.turns + (side == 0 ? 0 : piece.turn_count[0]);
  const double* rest = net.at(0, side * net.m);
  std::size_t stride = row;
  double from = 0.0;
  parts_.resize(2 * part_size * turn_count);
  for (int k = 0; k <= turn_count; ++k) {
    Border& border = next_border();
    const double to = k < turn_count ? turns[k] : 1.0;
    border.a = from, border.da = to - from, border.b = side, border.db = 0.0;
    border.points = rest, border.stride = stride;
    if (k < turn_count) {
      double *left = parts_.data() + 2 * part_size * k, *right = left + part_size;
      split_curve(rest, stride, net.n, (to - from) / (1.0 - from), left, right);
      border.points = left, border.stride = 4;
      rest = right, stride = 4;
    }
    border.solve(net.n, y, count);
    from = to;
  }
}

CutPoint PieceCutter::Border::point(int plane) const {
  const int k = plane - first;
  const double t = roots.a[k];
  return {a + da * t, b + db * t, roots.x[k], roots.key[k]};
}

// A plane crosses if y is above one end and not above the other: all borders that share a corner judge it alike.
void PieceCutter::Border::solve(int degree, const double* y, int plane_count) {
  const double *begin = points, *end = points + degree * stride;
  const double y0 = begin[kY] / begin[kW], y1 = end[kY] / end[kW];
  first = int(std::upper_bound(y, y + plane_count, std::min(y0, y1)) - y);
  last = int(std::upper_bound(y + first, y + plane_count, std::max(y0, y1)) - y);
  if (first == last) return;
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
  if (piece.has_accurate_centred_net()) {
    jacobians(piece.centred, count, folds_);
    jacobians(piece.centred, count, to_folds_);
  } else {
    for (std::size_t k = 0; k < count; ++k) {
      folds_.step[k] = jacobian_at(piece, arcs_[k].from), to_folds_.step[k] = jacobian_at(piece, arcs_[k].to);
    }
  }
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
  fold_roots(piece.centred, folds, folds_);
  split_.clear();
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const CutArc& arc = arcs_[k];
    if (next == folds || fold_arcs_[next] != int(k)) {
      split_.push_back(arc);
      continue;
    }
    // There is one fold between the ends, so what converged between them is it.
    const bool found = piece.has_accurate_centred_net() && folds_.step[next] < kRootStep &&
                       folds_.a[next] > arc.from.a && folds_.a[next] < arc.to.a;
    const CutPoint fold = found ? CutPoint{folds_.a[next], folds_.b[next], folds_.x[next], folds_.key[next], true}
                                : solve_fold(piece, y[arc.plane], arc.from, arc.to);
    split_.push_back({arc.plane, arc.curve, arc.from, fold});
    split_.push_back({arc.plane, arc.curve, fold, arc.to});
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
