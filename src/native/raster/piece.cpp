#include "raster/piece.h"

#include <cmath>
#include <cstring>
#include <optional>

#include "bezier/turning.h"
#include "patch_normal.h"
#include "placed_patch.h"

namespace nofacet {
namespace {

constexpr double kSameTurn = 1e-9;      // of a piece
constexpr int kMaxDepth = 100;          // halvings of one patch, both directions together
constexpr int64_t kMaxNodes = 1 << 22;  // visits for one patch; an honest patch needs a few hundred
// A curved piece larger than this is split even if certified: bounds get poor and digits are lost. Where a degree is
// beyond 3, smaller pieces pay by needing fewer powers (CentredNet).
constexpr double kLargestPiece = 1024.0, kLargestCostlyPiece = 128.0;
// Certified pieces that many planes meet are halved up to so many times more where their bounds are poor: folds without
// shears, and what may bend, on all planes together, by more than this many times its width.
constexpr int kMaxCalmings = 4;
constexpr double kFoldPlanes = 8.0, kWildPlanes = 64.0, kWildBends = 2e4;
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

// Bounds of d^2 f / da^2 along the cuts y = const, on which db/da = -y_a / y_b. As y is constant there, f - c y bends
// as f does, for any c; with c = f_b / y_b how b itself bends drops out.
Interval bend_along_cut(const QuotientBounds& f, const QuotientBounds& y) {
  const Interval slope = -(y.fa / y.fb), c = f.fb / y.fb;
  return f.faa - c * y.faa + (f.fab - c * y.fab) * slope * 2.0 + (f.fbb - c * y.fbb) * square(slope);
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

Interval weight_range(const Net& net) {
  Interval weight = Interval::empty();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) weight.include(p[kW]);
  return weight;
}

// Appends the parameters at which the border of control points first, first + stride, ... turns in the screen's y.
void append_turns(const double* first, int degree, std::size_t stride, std::vector<double>& out) {
  // Control points whose y runs one way are those of a curve whose y does (variation diminishing property).
  bool rises = true, falls = true;
  double before = first[kY] / first[kW];
  for (int k = 1; k <= degree; ++k) {
    const double* p = first + k * stride;
    const double y = p[kY] / p[kW];
    rises &= y >= before;
    falls &= y <= before;
    before = y;
  }
  if (rises || falls) return;
  double polynomial[kMaxPolynomial + 1], roots[kMaxPolynomial + 1];
  const int n = turning_polynomial(first, stride, kY, kW, degree, polynomial);
  const int count = bernstein_roots(polynomial, n, roots);
  for (int k = 0; k < count; ++k) {
    if (roots[k] > 0.0 && roots[k] < 1.0) out.push_back(roots[k]);
  }
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

Net projected_net(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch,
                  std::vector<double>& points) {
  const PatchGroup& group = scene.model.groups[patch.group];
  Net net{group.degree_u, group.degree_v, nullptr};
  points.resize(net.size());
  project_patch(scene, camera, face, patch, points.data());
  normalize_weights(points);
  net.points = points.data();
  return net;
}

void PieceBuilder::add_patch(int32_t face, const Scene::PatchRef& patch, const HiddenTest* hidden,
                             std::vector<Piece>& out) {
  face_ = face;
  patch_ = &patch;
  region_ = scene_.regions[scene_.model.face_definition[face]].get();
  hidden_ = hidden;
  out_ = &out;
  nodes_ = 0;

  const Net net = projected_net(scene_, camera_, face, patch, projected_);
  Node root{net, {}, {}, {}, {0.0, 1.0, 0.0, 1.0}, 0};
  carry_forms(root);
  if (!region_) {
    subdivide(root, nullptr, 0);
    return;
  }
  Arcs arcs;
  arcs.reserve(region_->arcs().size());
  for (const TrimArc& arc : region_->arcs()) arcs.push_back(&arc);
  if (arc_stack_.size() < kMaxDepth + 2) arc_stack_.resize(kMaxDepth + 2);
  subdivide(root, &arcs, 0);
}

// The forms of the whole patch, if they are small and it needs them: subdivision then halves them with the net.
void PieceBuilder::carry_forms(Node& root) {
  const Net& net = root.net;
  if (net.n > kMaxJacobianDegree || net.m > kMaxJacobianDegree) return;
  scales_.rational = false;
  scales_.weight = INFINITY;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    scales_.weight = std::min(scales_.weight, p[kW]);
    scales_.rational |= p[kW] != 1.0;
  }
  if (!(scales_.weight > 0)) return;
  const JacobianDegrees degrees(net.n, net.m, scales_.rational);
  root.jacobian = {degrees.j_n, degrees.j_m, nullptr};
  root.turn = {degrees.turn_n, degrees.turn_m, nullptr};
  root.key_jacobian = root.jacobian;
  forms_.resize(2 * root.jacobian.size() + root.turn.size());
  root.jacobian.coefficients = forms_.data();
  scales_.jacobian_terms = jacobian_form(net, scales_.rational, kX, root.jacobian);
  const auto [lo, hi] = std::minmax_element(forms_.data(), forms_.data() + root.jacobian.size());
  if (*lo > 0 || *hi < 0) return;  // no folds
  root.turn.coefficients = forms_.data() + root.jacobian.size();
  scales_.turn_terms = turn_form(net, scales_.rational, root.jacobian, root.turn);
  root.key_jacobian.coefficients = root.turn.coefficients + root.turn.size();
  jacobian_form(net, scales_.rational, kZ, root.key_jacobian);
}

void PieceBuilder::subdivide(const Node& node, const Arcs* arcs, int depth) {
  const Net& net = node.net;
  const Box& box = node.box;
  if (++nodes_ > kMaxNodes) {
    ++unresolved_;
    return;
  }
  // Off the screen, or between two planes; bounds of a distorted piece (below) say nothing of that.
  const Interval weight = weight_range(net);
  const bool distorted = camera_.perspective && weight.lo * kLargestDepthRatio < weight.hi;
  if (distorted && is_off_screen(net, camera_)) return;
  const ComponentRanges range = distorted ? ComponentRanges{} : ratio_ranges(net);
  const Interval x = range[kX], y = range[kY];
  if (!distorted) {
    if (x.hi < 0 || x.lo > camera_.width || !planes_.any_in(y.lo, y.hi)) return;
    if (hidden_ && (*hidden_)(hull_bounds(net, x, y, range[kZ]))) return;
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
  if (distorted) {
    if (depth < kMaxDepth) {
      halve(node, arcs, depth, space_length(net, true) >= space_length(net, false));
    } else if (weight.lo > 0) {
      ++unresolved_;
    }
    return;
  }

  std::optional<NetBounds> bounds;  // many nodes need no more than the forms that they carry
  const auto all_bounds = [&]() -> const NetBounds& { return bounds ? *bounds : bounds.emplace(net, range); };
  const Certificate certificate = node.jacobian.coefficients ? certify_cut(slope_bounds(net, y), node.jacobian,
                                                                           node.turn, node.key_jacobian, scales_)
                                                             : certify_cut(net, all_bounds());
  if (certificate.kind != CutKind::uncertain) {
    const double largest = std::max(net.n, net.m) > 3 ? kLargestCostlyPiece : kLargestPiece;
    const bool small = x.width() <= largest && y.width() <= largest;
    const bool last = depth >= kMaxDepth || is_planar(net, range[kZ]);
    if (small || last) {
      const Halve parameter = last ? Halve::either : calming(node, certificate, all_bounds());
      if (parameter == Halve::either) return emit_certified(node, all_bounds(), certificate, arcs);
      Node wild = node;
      ++wild.calmings;
      return halve(wild, arcs, depth, parameter == Halve::a);
    }
  } else {
    const bool narrow = x.width() < kNegligiblePixels, low = y.width() < kNegligiblePixels;
    if (narrow && low) {
      Piece piece{};
      piece.kind = CutKind::uncertain;
      piece.hull = {x, y, range[kZ], {range[kZ].mid(), 0.0, 0.0, 0.5 * range[kZ].width()}, 0.0, x};
      piece.shears = {-INFINITY, INFINITY};
      emit(piece, net, box, arcs);
      return;
    }
    if (narrow || low) return;  // seen edge-on: no area
    if (depth >= kMaxDepth) {
      ++unresolved_;
      return;
    }
  }
  if (certificate.kind == CutKind::uncertain && !certificate.graph && depth < kMaxDepth / 2) {
    if (const auto core = find_level_box(net, planes_)) return peel(node, *core, arcs, depth);
  }
  halve(node, arcs, depth,
        certificate.halve == Halve::either ? shape_halves_a(net, all_bounds()) : certificate.halve == Halve::a);
}

// Which parameter to halve a certified node by, or either if that does not pay. Where little is known of how the depth
// runs along its cuts, its spans are compared with others point by point, on every plane.
Halve PieceBuilder::calming(const Node& node, const Certificate& certificate, const NetBounds& bounds) const {
  if (!node.key_jacobian.coefficients || node.calmings == kMaxCalmings) return Halve::either;
  const double planes = bounds.y.f.width() * planes_.per_row();
  const bool has_shears = certificate.shears.lo <= certificate.shears.hi;
  if (certificate.kind == CutKind::fold && !has_shears && planes > kFoldPlanes) return certificate.halve;
  if (certificate.kind > CutKind::fold || planes < kWildPlanes) return Halve::either;
  const bool transposed = certificate.transposed;
  const QuotientBounds x = transposed ? transposed_bounds(bounds.x) : bounds.x;
  const QuotientBounds y = transposed ? transposed_bounds(bounds.y) : bounds.y;
  if (planes * bend_along_cut(x, y).magnitude() < kWildBends * x.f.width()) return Halve::either;
  // Bends are wild where y_b is small here and large there.
  return (y.fab.magnitude() >= y.fbb.magnitude()) != transposed ? Halve::a : Halve::b;
}

void PieceBuilder::halve(const Node& node, const Arcs* arcs, int depth, bool along_a) {
  const auto [first, second] = cut(node, depth, along_a, 0.5);
  subdivide(first, arcs, depth + 1);
  subdivide(second, arcs, depth + 1);
}

// Subdivides what surrounds the core side by side, and the core in the end: most likely no plane meets it.
void PieceBuilder::peel(const Node& node, const ParameterBox& core, const Arcs* arcs, int depth) {
  const bool along_a = core.a.lo > 0.0 || core.a.hi < 1.0;
  const Interval range = along_a ? core.a : core.b;
  if (range.lo <= 0.0 && range.hi >= 1.0) return subdivide(node, arcs, depth);
  const bool first_is_side = range.lo > 0.0;
  const double t = first_is_side ? range.lo : range.hi;
  const auto [first, second] = cut(node, depth, along_a, t);
  const Interval rest = first_is_side ? Interval{0.0, (range.hi - t) / (1.0 - t)} : Interval{0.0, 1.0};
  const ParameterBox inner = along_a ? ParameterBox{rest, core.b} : ParameterBox{core.a, rest};
  subdivide(first_is_side ? first : second, arcs, depth + 1);
  peel(first_is_side ? second : first, inner, arcs, depth + 1);
}

std::pair<PieceBuilder::Node, PieceBuilder::Node> PieceBuilder::cut(const Node& node, int depth, bool along_a,
                                                                    double t) {
  if (stack_.size() < kMaxDepth + 2) stack_.resize(kMaxDepth + 2);
  const Net& net = node.net;
  constexpr Grid Node::* kForms[] = {&Node::jacobian, &Node::turn, &Node::key_jacobian};
  std::size_t all = net.size();
  for (Grid Node::* form : kForms) all += (node.*form).coefficients ? (node.*form).size() : 0;
  if (stack_[depth].size() < 2 * all) stack_[depth].resize(2 * all);
  double *left = stack_[depth].data(), *right = left + all;
  Node first = node, second = node;
  first.net.points = left, second.net.points = right;
  split_net(net.points, net.n, net.m, 4, along_a, t, left, right);
  left += net.size(), right += net.size();
  for (Grid Node::* form : kForms) {
    const Grid& whole = node.*form;
    if (!whole.coefficients) continue;
    split_net(whole.coefficients, whole.n, whole.m, 1, along_a, t, left, right);
    (first.*form).coefficients = left, (second.*form).coefficients = right;
    left += whole.size(), right += whole.size();
  }
  if (along_a) {
    first.box.s1 = second.box.s0 = node.box.s0 + t * (node.box.s1 - node.box.s0);
  } else {
    first.box.t1 = second.box.t0 = node.box.t0 + t * (node.box.t1 - node.box.t0);
  }
  return {first, second};
}

namespace {

// Pixels on the screen's scale that a unit of the key stands for, at most.
double pixels_per_key(const Camera& camera, Interval key) {
  if (camera.side) return 1.0;
  return camera.perspective ? camera.scale / key.mignitude() : camera.scale;
}

}  // namespace

// A large plane is one piece, however large.
bool PieceBuilder::is_planar(const Net& net, Interval key) const {
  return net.n == 1 && net.m == 1 && fit_key_plane(net, key).error * pixels_per_key(camera_, key) < kNegligiblePixels;
}

namespace {

// Bounds of key_jacobian / jacobian, which is d key / dx along the cuts, where the Jacobian has one sign. Where it
// vanishes they are infinite, on one side if the other form does not vanish there. `negligible`: what counts as zero.
Interval slopes(const Grid& key_jacobian, const Grid& jacobian, double negligible) {
  const double sign = jacobian.range().mid() < 0 ? -1.0 : 1.0;
  Interval range = Interval::empty();
  for (std::size_t k = 0; k < jacobian.size(); ++k) {
    const double j = sign * jacobian.coefficients[k], key = sign * key_jacobian.coefficients[k];
    if (j > negligible) {
      range.include(key / j);
      continue;
    }
    if (!(key < -negligible)) range.hi = INFINITY;
    if (!(key > negligible)) range.lo = -INFINITY;
  }
  return range;
}

}  // namespace

// Fills in what is known of the tangents, on the screen's scale, and of the normals made of them.
void bound_tangents(const QuotientBounds& x, const QuotientBounds& y, const QuotientBounds& key, double key_pixels,
                    Piece* piece) {
  const double jacobian = (x.fa * y.fb - x.fb * y.fa).mignitude();
  const double xa = x.fa.magnitude(), xb = x.fb.magnitude(), ya = y.fa.magnitude(), yb = y.fb.magnitude();
  const double ka = key_pixels * key.fa.magnitude(), kb = key_pixels * key.fb.magnitude();
  piece->reach = 1.0 + (ka * (xb + yb) + kb * (xa + ya)) / jacobian;
  const double longest_a = std::sqrt(xa * xa + ya * ya + ka * ka), longest_b = std::sqrt(xb * xb + yb * yb + kb * kb);
  const double least_a = jacobian / longest_b, least_b = std::max(jacobian / longest_a, y.fb.mignitude());
  const bool sound = jacobian > kFlat * longest_a * longest_b && least_a >= kDegenerate * longest_b &&
                     least_b >= kDegenerate * longest_a;
  piece->least_tangent = sound ? std::min(least_a, least_b) : 0.0;
}

// Fills in what a certified piece knows of its cuts.
void PieceBuilder::describe(const Net& net, const NetBounds& bounds, const Certificate& certificate, const Node& node,
                            const Box& box, Piece* piece) const {
  piece->kind = certificate.kind;
  piece->transposed = certificate.transposed;

  const QuotientBounds y = piece->transposed ? transposed_bounds(bounds.y) : bounds.y;
  const QuotientBounds key = piece->transposed ? transposed_bounds(bounds.key) : bounds.key;
  piece->rising = y.fb.positive();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) piece->rational |= p[kW] != 1.0;
  const double key_pixels = pixels_per_key(camera_, key.f);
  piece->hull = hull_bounds(net, bounds.x.f, bounds.y.f, bounds.key.f);
  piece->planar = piece->hull.plane.error * key_pixels < kNegligiblePixels;
  const QuotientBounds x = piece->transposed ? transposed_bounds(bounds.x) : bounds.x;
  piece->key_slope = key.fa - (y.fa / y.fb) * key.fb;
  if (node.key_jacobian.coefficients) {
    const Interval w = weight_range(net), cubed{w.lo * w.lo * w.lo, w.hi * w.hi * w.hi};
    // The form is that of the patch's own parameters.
    const double area = (box.s1 - box.s0) * (box.t1 - box.t0);
    const Interval along = node.key_jacobian.range() * (piece->transposed ? -area : area);
    piece->key_slope = intersect(piece->key_slope, along / (y.fb * cubed));
    piece->shears = piece->kind == CutKind::fold
                        ? certificate.shears
                        : slopes(node.key_jacobian, node.jacobian, kRoundingMargin * scales_.jacobian_terms);
  } else if (node.jacobian.coefficients && !piece->planar) {
    // Without folds the depth's form is not carried along.
    double forms[2 * kMaxJacobianSize];
    Grid jacobian = node.jacobian, key_jacobian = node.jacobian;
    jacobian.coefficients = forms, key_jacobian.coefficients = forms + kMaxJacobianSize;
    const double terms = jacobian_form(net, scales_.rational, kX, jacobian);
    jacobian_form(net, scales_.rational, kZ, key_jacobian);
    piece->shears = slopes(key_jacobian, jacobian, kRoundingMargin * terms);
  } else if (piece->kind == CutKind::fold) {
    piece->shears = piece->key_slope.one_signed() ? Interval{0.0, 0.0} : Interval::empty();
  } else {
    const Interval x_slope = x.fa - (y.fa / y.fb) * x.fb;
    piece->shears = x_slope.one_signed() ? piece->key_slope / x_slope : Interval{-INFINITY, INFINITY};
  }
  if (piece->kind == CutKind::sliver) piece->shears = {-INFINITY, INFINITY};  // x may turn
  piece->x_bend = bend_along_cut(x, y), piece->key_bend = bend_along_cut(key, y);
  bound_tangents(x, y, key, key_pixels, piece);
  piece->bend = std::max({bounds.x_remainder, bounds.y_remainder, bounds.key_remainder * key_pixels});
}

// Stores a certified piece with the turns of the borders along its cuts. A trimmed one is cut at them instead: then no
// scan plane meets a border twice, and what lies between two trim crossings is one stretch.
void PieceBuilder::emit_certified(const Node& node, const NetBounds& bounds, const Certificate& certificate,
                                  const Arcs* arcs) {
  const Net& net = node.net;
  const bool across = certificate.transposed;
  const int degree = across ? net.m : net.n;
  const std::size_t stride = across ? 4 : 4 * std::size_t(net.m + 1);
  turns_.clear();
  append_turns(net.at(0, 0), degree, stride, turns_);
  const std::size_t first_count = turns_.size();
  append_turns(across ? net.at(net.n, 0) : net.at(0, net.m), degree, stride, turns_);
  if (arcs && !turns_.empty()) return emit_cut_at_turns(node, certificate, arcs);
  Piece piece{};
  describe(net, bounds, certificate, node, node.box, &piece);
  double* turns = turn_arena_.take(turns_.size());
  std::copy(turns_.begin(), turns_.end(), turns);
  piece.turns = turns;
  piece.turn_count[0] = int32_t(first_count), piece.turn_count[1] = int32_t(turns_.size() - first_count);
  emit(piece, net, node.box, arcs);
}

void PieceBuilder::emit_cut_at_turns(const Node& node, const Certificate& certificate, const Arcs* arcs) {
  const Net& net = node.net;
  const Box& box = node.box;
  std::sort(turns_.begin(), turns_.end());
  // Both borders may turn at one place but for rounding. What lies between would be all rounding, and a border that
  // turns so near its end goes back by the square of that.
  double last = 0.0;
  std::erase_if(turns_, [&](double turn) {
    if (turn - last < kSameTurn || 1.0 - turn < kSameTurn) return true;
    last = turn;
    return false;
  });
  turns_.push_back(1.0);
  part_.resize(net.size());
  double from = 0.0;
  for (const double to : turns_) {
    Box inner = box;
    if (certificate.transposed) {
      restrict_net(net, 0.0, 1.0, from, to, part_.data());
      inner.t0 = box.t0 + from * (box.t1 - box.t0), inner.t1 = box.t0 + to * (box.t1 - box.t0);
    } else {
      restrict_net(net, from, to, 0.0, 1.0, part_.data());
      inner.s0 = box.s0 + from * (box.s1 - box.s0), inner.s1 = box.s0 + to * (box.s1 - box.s0);
    }
    const Net part{net.n, net.m, part_.data()};
    Piece piece{};
    describe(part, NetBounds(part), certificate, node, inner, &piece);
    emit(piece, part, inner, arcs);
    from = to;
  }
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
  if (piece.kind != CutKind::uncertain) {
    piece.centred = centre_net(piece.net, pixels_per_key(camera_, piece.hull.key), nets_.take(net.size()));
  }
  if (arcs) {
    piece.region = region_;
    if (piece.kind != CutKind::uncertain) add_portions(piece, *arcs);
  }
  out_->push_back(piece);
}

void PieceBuilder::add_portions(Piece& piece, const Arcs& arcs) {
  const auto store = [](const auto& list, auto& arena) {
    auto* stored = arena.take(list.size());
    std::copy(list.begin(), list.end(), stored);
    return stored;
  };
  portions_.clear();
  events_.clear();
  const NetBounds bounds(piece.net);
  PortionFinder finder(piece, bounds, planes_, portions_, events_);
  for (const TrimArc* arc : arcs) finder.add(*arc);
  finder.finish();
  piece.portions = store(portions_, portion_arena_);
  piece.portion_count = int32_t(portions_.size());
  piece.events = store(events_, event_arena_);
  piece.event_count = int32_t(events_.size());
}

}  // namespace nofacet
