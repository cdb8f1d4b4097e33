#include "raster/piece.h"

#include <cmath>
#include <cstring>

namespace nofacet {
namespace {

constexpr int kMaxDepth = 100;          // halvings of one patch, both directions together
constexpr int64_t kMaxNodes = 1 << 22;  // visits for one patch; an honest patch needs a few hundred
// A curved piece larger than this is split even if certified: depth bounds and first guesses get poor.
constexpr double kLargestPiece = 256.0;
// Largest ratio of depths within a piece in perspective.
constexpr double kLargestDepthRatio = 4.0;

// How much halving a parameter would flatten the piece: the size of the second differences it divides.
double curvature_along(const QuotientBounds& x, const QuotientBounds& y, bool a) {
  const double own =
      a ? std::max(x.faa.magnitude(), y.faa.magnitude()) : std::max(x.fbb.magnitude(), y.fbb.magnitude());
  return own + 0.5 * std::max(x.fab.magnitude(), y.fab.magnitude());
}

double length_along(const Net& net, bool a) {
  double longest = 0.0;
  const int n = a ? net.n : net.m, m = a ? net.m : net.n;
  for (int k = 0; k <= m; k += m > 0 ? m : 1) {
    double length = 0.0;
    for (int i = 0; i < n; ++i) {
      const double* p = a ? net.at(i, k) : net.at(k, i);
      const double* q = a ? net.at(i + 1, k) : net.at(k, i + 1);
      length += std::hypot(q[kX] / q[kW] - p[kX] / p[kW], q[kY] / q[kW] - p[kY] / p[kW]);
    }
    longest = std::max(longest, length);
  }
  return longest;
}

// Whether to halve a rather than b: what is bent most, or what is longer.
bool shape_halves_a(const Net& net, const NetBounds& bounds) {
  const double bend_a = curvature_along(bounds.x, bounds.y, true), bend_b = curvature_along(bounds.x, bounds.y, false);
  const double length_a = length_along(net, true), length_b = length_along(net, false);
  const bool nearly_flat = std::max(bend_a, bend_b) < 1e-2 * std::max(length_a, length_b);
  return nearly_flat ? length_a >= length_b : bend_a >= bend_b;
}

// Length of the control polygons along a or b in eye space (perspective only: Z is the weight there).
double space_length(const Net& net, bool a) {
  double longest = 0.0;
  const int n = a ? net.n : net.m, m = a ? net.m : net.n;
  for (int k = 0; k <= m; ++k) {
    double length = 0.0;
    for (int i = 0; i < n; ++i) {
      const double* p = a ? net.at(i, k) : net.at(k, i);
      const double* q = a ? net.at(i + 1, k) : net.at(k, i + 1);
      for (int c = 0; c < 3; ++c) length += std::fabs(q[c] / q[kZ] - p[c] / p[kZ]);
    }
    longest = std::max(longest, length);
  }
  return longest;
}

// Whether no scan plane meets the border of control points first, first + stride, ... twice: the screen y of its
// control points runs one way (variation diminishing property).
bool monotone_border(const double* first, int degree, std::size_t stride) {
  bool rises = true, falls = true;
  double before = first[kY] / first[kW];
  for (int k = 1; k <= degree; ++k) {
    const double* p = first + k * stride;
    const double y = p[kY] / p[kW];
    rises &= y >= before;
    falls &= y <= before;
    before = y;
  }
  return rises || falls;
}

// The borders along the cut's parameter; the certificate has seen to the other two.
bool monotone_borders(const Net& net, bool transposed) {
  const std::size_t row = 4 * std::size_t(net.m + 1);
  if (transposed) return monotone_border(net.at(0, 0), net.m, 4) && monotone_border(net.at(net.n, 0), net.m, 4);
  return monotone_border(net.at(0, 0), net.n, row) && monotone_border(net.at(0, net.m), net.n, row);
}

// Weights that are all the same become 1: the renderer has shorter ways for polynomial patches.
void normalize_weights(std::vector<double>& points) {
  const double w = points[kW];
  for (std::size_t k = 0; k < points.size(); k += 4) {
    if (points[k + kW] != w) return;
  }
  if (w == 1.0 || !(w > 0.0)) return;
  for (double& p : points) p /= w;
}

}  // namespace

void PieceBuilder::add_patch(int32_t face, const Scene::PatchRef& patch, std::vector<Piece>& out) {
  const Model& model = scene_.model;
  const PatchGroup& group = model.groups[patch.group];
  const int32_t definition = model.face_definition[face];
  const double* placement = model.placements + 16 * std::size_t(model.face_placement[face]);
  face_ = face;
  patch_ = &patch;
  region_ = scene_.regions[definition].get();
  out_ = &out;
  nodes_ = 0;

  std::vector<double> projected;
  Net net{group.degree_u, group.degree_v, nullptr};
  projected.resize(net.size());
  const double* source = group.control_points + net.size() * patch.index;
  for (std::size_t k = 0; k < net.size(); k += 4) {
    double world[4];
    for (int r = 0; r < 3; ++r) {
      world[r] = Camera::dot(placement + 4 * r, source + k) + placement[4 * r + 3] * source[k + 3];
    }
    world[3] = source[k + 3];
    camera_.project(world, projected.data() + k);
  }
  normalize_weights(projected);
  net.points = projected.data();

  const Box whole{0.0, 1.0, 0.0, 1.0};
  if (!region_) {
    subdivide(net, whole, nullptr, 0);
    return;
  }
  Arcs arcs;
  arcs.reserve(region_->arcs().size());
  for (const TrimArc& arc : region_->arcs()) arcs.push_back(&arc);
  if (arc_stack_.size() < kMaxDepth + 2) arc_stack_.resize(kMaxDepth + 2);
  subdivide(net, whole, &arcs, 0);
}

// True if no point of the piece can be in front of the eye and inside the image: every control point lies beyond one
// of the frustum's planes, in homogeneous form, so it holds for pieces that cross the eye plane too.
bool PieceBuilder::behind_or_outside(const Net& net) const {
  bool behind = true, left = true, right = true, above = true, below = true;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    behind &= p[kW] <= 0;
    left &= p[kX] < 0;
    right &= p[kX] > camera_.width * p[kW];
    above &= p[kY] < 0;
    below &= p[kY] > camera_.height * p[kW];
  }
  return behind || left || right || above || below;
}

void PieceBuilder::subdivide(const Net& net, const Box& box, const Arcs* arcs, int depth) {
  if (behind_or_outside(net)) return;
  if (++nodes_ > kMaxNodes) {
    ++unresolved_;
    return;
  }

  // The trim arcs that still run through the piece; without any it is inside or outside as a whole.
  if (arcs) {
    Arcs& kept = arc_stack_[depth];
    kept.clear();
    const Interval u{patch_->u.face_from_patch(box.s0), patch_->u.face_from_patch(box.s1)};
    const Interval v{patch_->v.face_from_patch(box.t0), patch_->v.face_from_patch(box.t1)};
    for (const TrimArc* arc : *arcs) {
      const Interval au = arc->u_range(), av = arc->v_range();
      if (au.hi >= u.lo && au.lo <= u.hi && av.hi >= v.lo && av.lo <= v.hi) kept.push_back(arc);
    }
    arcs = &kept;
    if (kept.empty()) {
      if (!region_->contains(u.mid(), v.mid())) return;
      arcs = nullptr;
    }
  }

  // A piece that crosses the eye plane, or whose depths differ by much, is distorted beyond any bound: halve it in
  // space. What is in front shrinks towards the eye itself, where nothing is visible.
  Interval weight = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) weight.include(p[kW]);
  if (camera_.perspective && weight.lo * kLargestDepthRatio < weight.hi) {
    if (depth < kMaxDepth) {
      split(net, box, arcs, depth, space_length(net, true) >= space_length(net, false));
    } else if (weight.lo > 0) {
      ++unresolved_;
    }
    return;
  }

  const Interval y = hull_range(net, kY, kW);
  if (!planes_.any_in(y.lo, y.hi)) return;
  const NetBounds bounds(net);
  Piece piece{};
  const Certificate certificate = certify_cut(net, bounds);
  if (certificate.kind != CutKind::uncertain) {
    describe(net, bounds, certificate, &piece);
    const bool small = bounds.x.f.width() <= kLargestPiece && y.width() <= kLargestPiece;
    if (small || piece.planar || depth >= kMaxDepth) {
      emit(piece, net, box, arcs);
      return;
    }
  } else {
    const bool narrow = bounds.x.f.width() < kNegligiblePixels, low = y.width() < kNegligiblePixels;
    if (narrow && low) {
      piece.kind = CutKind::uncertain;
      piece.x = bounds.x.f;
      piece.y = y;
      emit(piece, net, box, arcs);
      return;
    }
    if (narrow || low) return;  // seen edge-on: no area
    if (depth >= kMaxDepth) {
      ++unresolved_;
      return;
    }
  }
  split(net, box, arcs, depth,
        certificate.halve == Halve::either ? shape_halves_a(net, bounds) : certificate.halve == Halve::a);
}

void PieceBuilder::split(const Net& net, const Box& box, const Arcs* arcs, int depth, bool along_a) {
  if (stack_.size() < kMaxDepth + 2) stack_.resize(kMaxDepth + 2);
  const std::size_t size = net.size();
  if (stack_[depth].size() < 2 * size) stack_[depth].resize(2 * size);
  double *left = stack_[depth].data(), *right = left + size;
  Box first = box, second = box;
  if (along_a) {
    split_a(net, left, right);
    first.s1 = second.s0 = 0.5 * (box.s0 + box.s1);
  } else {
    split_b(net, left, right);
    first.t1 = second.t0 = 0.5 * (box.t0 + box.t1);
  }
  subdivide({net.n, net.m, left}, first, arcs, depth + 1);
  subdivide({net.n, net.m, right}, second, arcs, depth + 1);
}

// Fills in what a certified piece knows of its cuts.
void PieceBuilder::describe(const Net& net, const NetBounds& bounds, const Certificate& certificate,
                            Piece* piece) const {
  piece->kind = certificate.kind;
  piece->transposed = certificate.transposed;
  piece->x = bounds.x.f;
  piece->y = bounds.y.f;

  const QuotientBounds y = piece->transposed ? transposed_bounds(bounds.y) : bounds.y;
  QuotientBounds key = quotient_bounds(net, kZ, kW);
  if (piece->transposed) key = transposed_bounds(key);
  piece->rising = y.fb.positive();
  piece->key = key.f;
  piece->key_slope = key.fa - (y.fa / y.fb) * key.fb;
  const auto remainder = [](const QuotientBounds& q) {
    return 0.5 * (q.faa.magnitude() + 2.0 * q.fab.magnitude() + q.fbb.magnitude());
  };
  const double key_pixels = pixels_per_key(key.f);
  piece->bend = std::max({remainder(bounds.x), remainder(bounds.y), remainder(key) * key_pixels});
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) piece->rational |= p[kW] != 1.0;
  fit_key_plane(net, piece);
  piece->planar = piece->key_plane.error * key_pixels < kNegligiblePixels;
  piece->simple_borders = monotone_borders(net, piece->transposed);
}

// Pixels on the screen's scale that a unit of the key stands for, at most.
double PieceBuilder::pixels_per_key(Interval key) const {
  return camera_.perspective ? camera_.scale / key.mignitude() : camera_.scale;
}

// The plane through the mean directions of the net, with the hull's distance from it. If the piece is too curved, or
// edge-on, a plane of constant key is better.
void PieceBuilder::fit_key_plane(const Net& net, Piece* piece) const {
  const auto at = [&](int i, int j, Component c) {
    const double* p = net.at(i, j);
    return p[c] / p[kW];
  };
  const auto mean_a = [&](Component c) { return at(net.n, 0, c) - at(0, 0, c) + at(net.n, net.m, c) - at(0, net.m, c); };
  const auto mean_b = [&](Component c) { return at(0, net.m, c) - at(0, 0, c) + at(net.n, net.m, c) - at(net.n, 0, c); };
  const double xa = mean_a(kX), ya = mean_a(kY), ka = mean_a(kZ), xb = mean_b(kX), yb = mean_b(kY), kb = mean_b(kZ);
  const double determinant = xa * yb - xb * ya;
  KeyPlane& plane = piece->key_plane;
  plane = {piece->key.mid(), 0.0, 0.0, 0.5 * piece->key.width()};
  const double by_x = (ka * yb - kb * ya) / determinant, by_y = (kb * xa - ka * xb) / determinant;
  if (!std::isfinite(by_x) || !std::isfinite(by_y)) return;
  Interval rest = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    rest.include((p[kZ] - by_x * p[kX] - by_y * p[kY]) / p[kW]);
  }
  if (0.5 * rest.width() < plane.error) plane = {rest.mid(), by_x, by_y, 0.5 * rest.width()};
}

void PieceBuilder::emit(Piece& piece, const Net& net, const Box& box, const Arcs* arcs) {
  double* points = nets_.take(net.size());
  piece.net = {net.n, net.m, points};
  if (piece.transposed) {
    transpose(net, points);
    std::swap(piece.net.n, piece.net.m);
  } else {
    std::memcpy(points, net.points, net.size() * sizeof(double));
  }
  piece.patch = patch_;
  piece.face = face_;
  piece.s0 = box.s0, piece.s1 = box.s1, piece.t0 = box.t0, piece.t1 = box.t1;
  if (piece.kind == CutKind::uncertain) piece.key = hull_range(net, kZ, kW);
  if (arcs) {
    piece.region = region_;
    if (piece.kind != CutKind::uncertain) {
      portions_.clear();
      for (const TrimArc* arc : *arcs) monotone_portions(piece, *arc, planes_, portions_);
      TrimPortion* stored = portion_arena_.take(portions_.size());
      std::copy(portions_.begin(), portions_.end(), stored);
      piece.portions = stored;
      piece.portion_count = int32_t(portions_.size());
    }
  }
  out_->push_back(piece);
}

}  // namespace nofacet
