#include "raster/piece.h"

#include <cmath>
#include <cstring>
#include <optional>

#include "bezier/turning.h"
#include "patch_normal.h"
#include "placed_patch.h"

namespace nofacet {
namespace {

constexpr double kSameTurn = 1e-9;  // of a piece
constexpr int kMaxDepth = 100;      // halvings of one patch, both directions together
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

// Length of the control polygons along a or b in homogeneous coordinates, which stay finite where W vanishes.
double homogeneous_length(const Net& net, bool a) {
  double longest = 0.0;
  const int n = a ? net.n : net.m, m = a ? net.m : net.n;
  for (int k = 0; k <= m; ++k) {
    double length = 0.0;
    for (int i = 0; i < n; ++i) {
      const double* p = a ? net.at(i, k) : net.at(k, i);
      const double* q = a ? net.at(i + 1, k) : net.at(k, i + 1);
      for (int c = 0; c < 4; ++c) length += std::fabs(q[c] - p[c]);
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

bool is_distorted(const Net& net, const Camera& camera) {
  if (!camera.perspective) return false;
  const Interval weight = weight_range(net);
  return weight.lo * kLargestDepthRatio < weight.hi;
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

void PieceBuilder::open(int32_t face, const Scene::PatchRef& patch, Part& part) {
  face_ = face;
  patch_ = &patch;
  region_ = scene_.regions[scene_.model.face_definition[face]].get();
  found_pieces_.clear(), found_parts_.clear();
  unresolved_ = 0;
  PartNet net = part.closed.net.points ? part.closed : project();
  if (find_arcs(net)) subdivide(net, part.hull);
  store(part);
  give_back(part.closed);
}

// The whole patch.
PartNet PieceBuilder::project() {
  PartNet whole;
  whole.net = projected_net(scene_, camera_, face_, *patch_, projected_);
  whole.trimmed = region_ != nullptr;
  whole.distorted = is_distorted(whole.net, camera_);
  carry_forms(whole);
  return whole;
}

// The forms of the whole patch, if they are small and it needs them: subdivision then halves them with the net.
void PieceBuilder::carry_forms(PartNet& whole) {
  const Net& net = whole.net;
  if (net.n > kMaxJacobianDegree || net.m > kMaxJacobianDegree) return;
  CarriedForms scales;
  scales.weight = INFINITY;
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) {
    scales.weight = std::min(scales.weight, p[kW]);
    scales.rational |= p[kW] != 1.0;
  }
  if (!(scales.weight > 0)) return;
  const JacobianDegrees degrees(net.n, net.m, scales.rational);
  whole.jacobian = {degrees.j_n, degrees.j_m, nullptr};
  whole.turn = {degrees.turn_n, degrees.turn_m, nullptr};
  whole.key_jacobian = whole.jacobian;
  forms_.resize(2 * whole.jacobian.size() + whole.turn.size());
  whole.jacobian.coefficients = forms_.data();
  scales.jacobian_terms = jacobian_form(net, scales.rational, kX, whole.jacobian);
  CarriedForms* stored = scale_arena_.take(1);
  whole.scales = stored;
  *stored = scales;
  const auto [lo, hi] = std::minmax_element(forms_.data(), forms_.data() + whole.jacobian.size());
  if (*lo > 0 || *hi < 0) return;  // no folds
  whole.turn.coefficients = forms_.data() + whole.jacobian.size();
  stored->turn_terms = turn_form(net, scales.rational, whole.jacobian, whole.turn);
  whole.key_jacobian.coefficients = whole.turn.coefficients + whole.turn.size();
  jacobian_form(net, scales.rational, kZ, whole.key_jacobian);
}

// Finds the trim arcs that still run through the part; without any it is inside or outside as a whole. Whether some of
// it may be inside.
bool PieceBuilder::find_arcs(PartNet& part) {
  arcs_.clear();
  if (!part.trimmed) return true;
  const Interval u{patch_->u.face_from_patch(part.s0), patch_->u.face_from_patch(part.s1)};
  const Interval v{patch_->v.face_from_patch(part.t0), patch_->v.face_from_patch(part.t1)};
  const auto add = [&](const TrimArc& arc) {
    const Interval au = arc.u_range(), av = arc.v_range();
    if (au.hi >= u.lo && au.lo <= u.hi && av.hi >= v.lo && av.lo <= v.hi) arcs_.push_back(&arc);
  };
  if (part.arcs.empty()) {
    for (const TrimArc& arc : region_->arcs()) add(arc);
  } else {
    for (const TrimArc* arc : part.arcs) add(*arc);
  }
  part.trimmed = !arcs_.empty();
  return part.trimmed || region_->contains(u.mid(), v.mid());
}

void PieceBuilder::subdivide(const PartNet& part, const HullBounds& hull) {
  const Net& net = part.net;
  // What is distorted beyond any bound is halved in space, not by how it looks. What stays distorted shrinks towards
  // the eye itself, where nothing is visible.
  if (part.distorted) {
    if (part.depth < kMaxDepth) {
      halve(part, homogeneous_length(net, true) >= homogeneous_length(net, false));
    } else if (weight_range(net).lo > 0) {
      ++unresolved_;
    }
    return;
  }

  const Interval x = hull.x, y = hull.y;
  ComponentRanges range;
  range.set(kX, hull.x), range.set(kY, hull.y), range.set(kZ, hull.key);
  std::optional<NetBounds> bounds;  // many parts need no more than the forms that they carry
  const auto all_bounds = [&]() -> const NetBounds& { return bounds ? *bounds : bounds.emplace(net, range); };
  const Certificate certificate = part.jacobian.coefficients ? certify_cut(slope_bounds(net, y), part.jacobian,
                                                                           part.turn, part.key_jacobian, *part.scales)
                                                             : certify_cut(net, all_bounds());
  if (certificate.kind != CutKind::uncertain) {
    const double largest = std::max(net.n, net.m) > 3 ? kLargestCostlyPiece : kLargestPiece;
    const bool small = x.width() <= largest && y.width() <= largest;
    const bool last = part.depth >= kMaxDepth || is_planar(net, hull.key);
    if (small || last) {
      const Halve parameter = last ? Halve::either : calming(part, certificate, all_bounds());
      if (parameter == Halve::either) return emit_certified(part, all_bounds(), hull, certificate);
      PartNet wild = part;
      ++wild.calmings;
      return halve(wild, parameter == Halve::a);
    }
  } else {
    const bool narrow = x.width() < kNegligiblePixels, low = y.width() < kNegligiblePixels;
    if (narrow && low) {
      Piece piece{};
      piece.kind = CutKind::uncertain;
      piece.hull = {x, y, hull.key, {hull.key.mid(), 0.0, 0.0, 0.5 * hull.key.width()}, 0.0, x};
      piece.shears = {-INFINITY, INFINITY};
      emit(piece, net, Box(part), part.trimmed);
      return;
    }
    if (narrow || low) return;  // seen edge-on: no area
    if (part.depth >= kMaxDepth) {
      ++unresolved_;
      return;
    }
  }
  if (certificate.kind == CutKind::uncertain && !certificate.graph && part.depth < kMaxDepth / 2) {
    if (const auto core = find_level_box(net, planes_)) return peel(part, *core);
  }
  halve(part, certificate.halve == Halve::either ? shape_halves_a(net, all_bounds()) : certificate.halve == Halve::a);
}

// Which parameter to halve a certified part by, or either if that does not pay. Where little is known of how the depth
// runs along its cuts, its spans are compared with others point by point, on every plane.
Halve PieceBuilder::calming(const PartNet& part, const Certificate& certificate, const NetBounds& bounds) const {
  if (!part.key_jacobian.coefficients || part.calmings == kMaxCalmings) return Halve::either;
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

void PieceBuilder::halve(const PartNet& part, bool along_a) {
  const auto [first, second] = cut(part, along_a, 0.5);
  add(first);
  add(second);
}

// Adds what surrounds the core side by side, and the core in the end: most likely no plane meets it.
void PieceBuilder::peel(const PartNet& part, const ParameterBox& core) {
  const bool along_a = core.a.lo > 0.0 || core.a.hi < 1.0;
  const Interval range = along_a ? core.a : core.b;
  const bool first_is_side = range.lo > 0.0;
  const double t = first_is_side ? range.lo : range.hi;
  auto [side, rest] = cut(part, along_a, t);
  if (!first_is_side) std::swap(side, rest);
  add(side);
  const Interval left = first_is_side ? Interval{0.0, (range.hi - t) / (1.0 - t)} : Interval{0.0, 1.0};
  const ParameterBox inner = along_a ? ParameterBox{left, core.b} : ParameterBox{core.a, left};
  const auto is_all = [](Interval part) { return part.lo <= 0.0 && part.hi >= 1.0; };
  if (is_all(inner.a) && is_all(inner.b)) return add(rest);
  peel(rest, inner);
  give_back(rest);
}

std::pair<PartNet, PartNet> PieceBuilder::cut(const PartNet& part, bool along_a, double t) {
  const Net& net = part.net;
  constexpr Grid PartNet::* kForms[] = {&PartNet::jacobian, &PartNet::turn, &PartNet::key_jacobian};
  std::size_t size = net.size();
  for (Grid PartNet::* form : kForms) size += (part.*form).coefficients ? (part.*form).size() : 0;
  PartNet first = part, second = part;
  double *left = first.memory = blocks_.take(size), *right = second.memory = blocks_.take(size);
  first.size = second.size = size;
  first.depth = second.depth = part.depth + 1;
  first.net.points = left, second.net.points = right;
  split_net(net.points, net.n, net.m, 4, along_a, t, left, right);
  left += net.size(), right += net.size();
  for (Grid PartNet::* form : kForms) {
    const Grid& whole = part.*form;
    if (!whole.coefficients) continue;
    split_net(whole.coefficients, whole.n, whole.m, 1, along_a, t, left, right);
    (first.*form).coefficients = left, (second.*form).coefficients = right;
    left += whole.size(), right += whole.size();
  }
  if (along_a) {
    first.s1 = second.s0 = part.s0 + t * (part.s1 - part.s0);
  } else {
    first.t1 = second.t0 = part.t0 + t * (part.t1 - part.t0);
  }
  return {first, second};
}

// Adds a part of the one being opened, unless it is off the screen or between two planes.
void PieceBuilder::add(PartNet part) {
  HullBounds hull;
  if (bound(part, &hull)) {
    found_parts_.push_back({hull, part});
  } else {
    give_back(part);
  }
}

bool PieceBuilder::bound(PartNet& part, HullBounds* hull) const {
  part.distorted = is_distorted(part.net, camera_);
  if (part.distorted) {
    *hull = kUnbounded;
    return !is_off_screen(part.net, camera_);
  }
  const ComponentRanges range = ratio_ranges(part.net);
  const Interval x = range[kX], y = range[kY];
  if (x.hi < 0 || x.lo > camera_.width || !planes_.any_in(y.lo, y.hi)) return false;
  *hull = hull_bounds(part.net, x, y, range[kZ]);
  return true;
}

void PieceBuilder::store(Part& part) {
  Piece* pieces = pieces_.take(found_pieces_.size());
  std::copy(found_pieces_.begin(), found_pieces_.end(), pieces);
  part.pieces = pieces;
  part.piece_count = int32_t(found_pieces_.size());
  part.unresolved = unresolved_;
  if (found_parts_.empty()) return;
  const TrimArc** arcs = arc_arena_.take(arcs_.size());
  std::copy(arcs_.begin(), arcs_.end(), arcs);
  // What is nearest may hide the others.
  std::stable_sort(found_parts_.begin(), found_parts_.end(),
                   [](const Found& p, const Found& q) { return p.hull.key.lo < q.hull.key.lo; });
  part.part_count = int32_t(found_parts_.size());
  part.parts = parts_.take(found_parts_.size());
  for (std::size_t k = 0; k < found_parts_.size(); ++k) {
    Part* inner = new (part.parts + k) Part;
    inner->hull = found_parts_[k].hull;
    inner->closed = found_parts_[k].net;
    inner->closed.arcs = {arcs, arcs_.size()};
  }
}

void PieceBuilder::give_back(const PartNet& part) {
  if (part.memory) blocks_.give_back(part.memory, part.size);
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
  piece->depth_rise = ka * (xb + yb) + kb * (xa + ya);
  piece->reach = 1.0 + piece->depth_rise / jacobian;
  const double longest_a = std::sqrt(xa * xa + ya * ya + ka * ka), longest_b = std::sqrt(xb * xb + yb * yb + kb * kb);
  piece->longest_a = longest_a, piece->longest_b = longest_b;
  const double least_a = jacobian / longest_b, least_b = std::max(jacobian / longest_a, y.fb.mignitude());
  const bool sound = jacobian > kFlat * longest_a * longest_b && least_a >= kDegenerate * longest_b &&
                     least_b >= kDegenerate * longest_a;
  piece->least_tangent = sound ? std::min(least_a, least_b) : 0.0;
}

// Fills in what a certified piece knows of its cuts.
void PieceBuilder::describe(const Net& net, const NetBounds& bounds, const HullBounds& hull,
                            const Certificate& certificate, const PartNet& part, const Box& box, Piece* piece) const {
  piece->kind = certificate.kind;
  piece->transposed = certificate.transposed;

  const QuotientBounds y = piece->transposed ? transposed_bounds(bounds.y) : bounds.y;
  const QuotientBounds key = piece->transposed ? transposed_bounds(bounds.key) : bounds.key;
  piece->rising = y.fb.positive();
  for (const double *p = net.points, *end = p + net.size(); p != end; p += 4) piece->rational |= p[kW] != 1.0;
  const double key_pixels = pixels_per_key(camera_, key.f);
  piece->hull = hull;
  piece->planar = piece->hull.plane.error * key_pixels < kNegligiblePixels;
  const QuotientBounds x = piece->transposed ? transposed_bounds(bounds.x) : bounds.x;
  piece->key_slope = key.fa - (y.fa / y.fb) * key.fb;
  if (part.key_jacobian.coefficients) {
    const Interval w = weight_range(net), cubed{w.lo * w.lo * w.lo, w.hi * w.hi * w.hi};
    // The form is that of the patch's own parameters.
    const double area = (box.s1 - box.s0) * (box.t1 - box.t0);
    const Interval along = part.key_jacobian.range() * (piece->transposed ? -area : area);
    piece->key_slope = intersect(piece->key_slope, along / (y.fb * cubed));
    piece->shears = piece->kind == CutKind::fold
                        ? certificate.shears
                        : slopes(part.key_jacobian, part.jacobian, kRoundingMargin * part.scales->jacobian_terms);
  } else if (part.jacobian.coefficients && !piece->planar) {
    // Without folds the depth's form is not carried along.
    double forms[2 * kMaxJacobianSize];
    Grid jacobian = part.jacobian, key_jacobian = part.jacobian;
    jacobian.coefficients = forms, key_jacobian.coefficients = forms + kMaxJacobianSize;
    const double terms = jacobian_form(net, part.scales->rational, kX, jacobian);
    jacobian_form(net, part.scales->rational, kZ, key_jacobian);
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
void PieceBuilder::emit_certified(const PartNet& part, const NetBounds& bounds, const HullBounds& hull,
                                  const Certificate& certificate) {
  const Net& net = part.net;
  const bool across = certificate.transposed;
  const int degree = across ? net.m : net.n;
  const std::size_t stride = across ? 4 : 4 * std::size_t(net.m + 1);
  turns_.clear();
  append_turns(net.at(0, 0), degree, stride, turns_);
  const std::size_t first_count = turns_.size();
  append_turns(across ? net.at(net.n, 0) : net.at(0, net.m), degree, stride, turns_);
  if (part.trimmed && !turns_.empty()) return emit_cut_at_turns(part, certificate);
  Piece piece{};
  describe(net, bounds, hull, certificate, part, Box(part), &piece);
  double* turns = turn_arena_.take(turns_.size());
  std::copy(turns_.begin(), turns_.end(), turns);
  piece.turns = turns;
  piece.turn_count[0] = int32_t(first_count), piece.turn_count[1] = int32_t(turns_.size() - first_count);
  emit(piece, net, Box(part), part.trimmed);
}

void PieceBuilder::emit_cut_at_turns(const PartNet& part, const Certificate& certificate) {
  const Net& net = part.net;
  const Box box(part);
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
    const Net stretch{net.n, net.m, part_.data()};
    const NetBounds bounds(stretch);
    Piece piece{};
    describe(stretch, bounds, hull_bounds(stretch, bounds.x.f, bounds.y.f, bounds.key.f), certificate, part, inner,
             &piece);
    emit(piece, stretch, inner, true);
    from = to;
  }
}

void PieceBuilder::emit(Piece& piece, const Net& net, const Box& box, bool trimmed) {
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
  if (trimmed) {
    piece.region = region_;
    if (piece.kind != CutKind::uncertain) add_portions(piece);
  }
  found_pieces_.push_back(piece);
}

void PieceBuilder::add_portions(Piece& piece) {
  const auto store = [](const auto& list, auto& arena) {
    auto* stored = arena.take(list.size());
    std::copy(list.begin(), list.end(), stored);
    return stored;
  };
  portions_.clear();
  events_.clear();
  const NetBounds bounds(piece.net);
  PortionFinder finder(piece, bounds, planes_, portions_, events_);
  for (const TrimArc* arc : arcs_) finder.add(*arc);
  finder.finish();
  piece.portions = store(portions_, portion_arena_);
  piece.portion_count = int32_t(portions_.size());
  piece.events = store(events_, event_arena_);
  piece.event_count = int32_t(events_.size());
}

}  // namespace nofacet
