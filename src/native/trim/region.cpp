#include "trim/region.h"

#include <algorithm>
#include <cmath>

#include "bezier/turning.h"

namespace nofacet {
namespace {

constexpr int kMaxTurns = 2 * kMaxPolynomial + 2;

}  // namespace

Region::Region(const Model& model, std::size_t definition) {
  const int64_t first_loop = model.definition_loops[definition], last_loop = model.definition_loops[definition + 1];
  const int64_t first = model.loop_offsets[first_loop], last = model.loop_offsets[last_loop];
  arcs_.reserve(last - first);
  for (int64_t k = first; k < last; ++k) {
    const int degree = int(model.segment_offsets[k + 1] - model.segment_offsets[k]) - 1;
    add_segment(model.segment_points + 3 * model.segment_offsets[k], degree);
  }
  fill_bins();
  add_knots();
  orientation_ = signed_area() < 0 ? -1 : 1;
}

// Of all loops together, positive if counterclockwise; by chords, so good for its sign.
double Region::signed_area() const {
  constexpr int kChords = 8;
  double twice = 0.0;
  for (const TrimArc& arc : arcs_) {
    CurvePoint from{arc.u0, arc.v0, 0, 0};
    const int chords = arc.degree == 1 ? 1 : kChords;
    for (int k = 1; k <= chords; ++k) {
      const CurvePoint to =
          k == chords ? CurvePoint{arc.u1, arc.v1, 0, 0} : arc.at(arc.t0 + (arc.t1 - arc.t0) * k / chords);
      twice += (from.u - arcs_[0].u0) * (to.v - arcs_[0].v0) - (to.u - arcs_[0].u0) * (from.v - arcs_[0].v0);
      from = to;
    }
  }
  return 0.5 * twice;
}

void Region::add_segment(const double* points, int degree) {
  double cuts[kMaxTurns] = {0.0};
  int count = 1;
  if (degree > 1) {
    double polynomial[kMaxPolynomial + 1];
    for (int coordinate = 0; coordinate < 2; ++coordinate) {
      const int n = turning_polynomial(points, 3, coordinate, 2, degree, polynomial);
      count += bernstein_roots(polynomial, n, cuts + count);
    }
  }
  cuts[count++] = 1.0;
  std::sort(cuts, cuts + count);
  CurvePoint from = evaluate_curve(points, degree, 0.0);
  for (int k = 1; k < count; ++k) {
    if (cuts[k] <= cuts[k - 1]) continue;
    const CurvePoint to = evaluate_curve(points, degree, cuts[k]);
    if (from.u != to.u || from.v != to.v) {
      TrimArc arc{points, degree, cuts[k - 1], cuts[k], from.u, from.v, to.u, to.v, {}, {}};
      derivative_bounds(points, degree, arc.t0, arc.t1, &arc.du, &arc.dv);
      arcs_.push_back(arc);
    }
    from = to;
  }
}

int Region::bin(double v) const { return std::clamp(int((v - v_min_) * bins_per_v_), 0, bins_ - 1); }

void Region::fill_bins() {
  if (arcs_.empty()) return;
  Interval range = Interval::empty();
  for (const TrimArc& arc : arcs_) range.include(arc.v0), range.include(arc.v1);
  v_min_ = range.lo, v_max_ = range.hi;
  bins_ = std::clamp(int(arcs_.size()), 1, 4096);
  bins_per_v_ = range.width() > 0 ? bins_ / range.width() : 0.0;
  bin_offsets_.assign(bins_ + 1, 0);
  for (const TrimArc& arc : arcs_) {
    const Interval v = arc.v_range();
    for (int k = bin(v.lo); k <= bin(v.hi); ++k) ++bin_offsets_[k + 1];
  }
  for (int k = 0; k < bins_; ++k) bin_offsets_[k + 1] += bin_offsets_[k];
  bin_arcs_.resize(bin_offsets_[bins_]);
  std::vector<int32_t> next(bin_offsets_.begin(), bin_offsets_.end() - 1);
  for (std::size_t k = 0; k < arcs_.size(); ++k) {
    const Interval v = arcs_[k].v_range();
    for (int b = bin(v.lo); b <= bin(v.hi); ++b) bin_arcs_[next[b]++] = int32_t(k);
  }
}

void Region::add_knots() {
  for (const TrimArc& arc : arcs_) {
    const bool straight = arc.degree == 1 && arc.points[2] == arc.points[5];
    first_knot_.push_back(straight ? -1 : int32_t(knots_.size()));
    if (straight) continue;
    knots_.push_back({arc.u0, arc.v0});
    for (int k = 1; k < kKnots; ++k) {
      const CurvePoint point = arc.at(arc.t0 + (arc.t1 - arc.t0) * k / kKnots);
      knots_.push_back({point.u, point.v});
    }
    knots_.push_back({arc.u1, arc.v1});
  }
}

// Whether an arc whose v range holds v passes left of u there.
bool Region::passes_left_of(std::size_t index, double u, double v) const {
  const TrimArc& arc = arcs_[index];
  const Interval range = arc.u_range();
  if (u < range.lo) return false;
  if (u >= range.hi) return true;
  TrimArc part = arc;
  if (first_knot_[index] >= 0) {
    const Knot* knots = knots_.data() + first_knot_[index];
    const bool rising = arc.v1 > arc.v0;
    const auto before = [&](const Knot& knot) { return rising ? knot.v <= v : knot.v > v; };
    const int k = std::clamp(int(std::partition_point(knots, knots + kKnots + 1, before) - knots) - 1, 0, kKnots - 1);
    const double step = (arc.t1 - arc.t0) / kKnots;
    part.t0 = arc.t0 + step * k, part.t1 = k + 1 == kKnots ? arc.t1 : arc.t0 + step * (k + 1);
    part.u0 = knots[k].u, part.v0 = knots[k].v, part.u1 = knots[k + 1].u, part.v1 = knots[k + 1].v;
    const Interval part_range = part.u_range();
    if (u < part_range.lo) return false;
    if (u >= part_range.hi) return true;
  }
  return part.at(part.parameter_at_v(v)).u <= u;
}

bool Region::clear(Interval u, Interval v) const {
  if (bins_ == 0 || v.hi < v_min_ || v.lo > v_max_) return true;
  const auto meets = [](Interval p, Interval q) { return p.lo <= q.hi && q.lo <= p.hi; };
  for (int32_t index = bin_offsets_[bin(v.lo)], end = bin_offsets_[bin(v.hi) + 1]; index < end; ++index) {
    const TrimArc& arc = arcs_[bin_arcs_[index]];
    if (meets(arc.u_range(), u) && meets(arc.v_range(), v)) return false;
  }
  return true;
}

bool Region::contains(double u, double v) const {
  if (bins_ == 0 || v < v_min_ || v > v_max_) return false;
  int winding = 0;
  const int k = bin(v);
  for (int32_t index = bin_offsets_[k]; index < bin_offsets_[k + 1]; ++index) {
    const TrimArc& arc = arcs_[bin_arcs_[index]];
    const Interval v_range = arc.v_range();
    if (v < v_range.lo || v >= v_range.hi) continue;  // half-open: a joint is counted once
    if (passes_left_of(bin_arcs_[index], u, v)) winding += arc.v1 < arc.v0 ? orientation_ : -orientation_;
  }
  return winding > 0 && winding % 2 == 1;
}

}  // namespace nofacet
