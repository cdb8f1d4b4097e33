#include "raster/section_cuts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace nofacet {
namespace {

constexpr double kBorderRoom = 1e-9;  // of a piece's parameters: what may be lost to rounding on its borders
// Pixels: how far from a scan plane with a gap in an outline another one without may be to stand in for it.
constexpr double kNeighbour = 2.0;

CutPoint point_of(const Piece& piece, double a, double b) {
  const Jet jet = evaluate(piece.net, a, b);
  return {a, b, jet.p[kX] / jet.p[kW], jet.p[kZ] / jet.p[kW]};
}

}  // namespace

void SectionCuts::cut(std::size_t band, const double* y, int count) {
  crossings_.clear(), borders_.clear();
  const auto planes_in = [&](Interval range) {
    const double* first = std::lower_bound(y, y + count, range.lo);
    return std::pair{int(first - y), int(std::upper_bound(first, y + count, range.hi) - y)};
  };
  for (std::size_t k = 0; k < sections_.views().size(); ++k) {
    SectionView& view = sections_.views()[k];
    const auto needs = [&](const HullBounds& hull) {
      const auto [first, last] = planes_in(hull.y);
      return first < last && hull.x.lo <= SectionView::kMiddle && hull.x.hi >= SectionView::kMiddle;
    };
    for (std::span<const int32_t> rest = view.bands[band]; !rest.empty(); rest = rest.subspan(1)) {
      view.patches->visit(rest, thread_, needs, [&](const Piece& piece) {
        const auto [first, last] = planes_in(piece.hull.y);
        if (needs(piece.hull)) cut_piece(k, piece, y, first, last);
      });
    }
  }
  std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& p, const Crossing& q) {
    return std::tie(p.face, p.patch, p.plane) < std::tie(q.face, q.patch, q.plane);
  });
  make_caps(y);
}

// The crossings of one piece of a side view with the scan planes [first, last).
void SectionCuts::cut_piece(std::size_t view, const Piece& piece, const double* y, int first, int last) {
  if (piece.kind == CutKind::uncertain) return;  // a point
  made_.clear();
  maker_.append(piece, y + first, last - first, first, sections_.views()[view].camera.width, made_);
  for (const Span& span : made_) {
    if (span.x0 < SectionView::kMiddle && span.x1 >= SectionView::kMiddle) add_crossing(view, span);
  }
}

void SectionCuts::add_crossing(std::size_t view, const Span& span) {
  const Piece& piece = *span.piece;
  const double progress = std::clamp((SectionView::kMiddle - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + progress * (span.a1 - span.a0), span.b0 + progress * (span.b1 - span.b0), {}};
  solve_sample(span, SectionView::kMiddle, span.y, &sample);
  const double x = sample.jet.p[kZ] / sample.jet.p[kW];
  double a = std::clamp(sample.a, 0.0, 1.0), b = std::clamp(sample.b, 0.0, 1.0);
  if (piece.transposed) std::swap(a, b);
  crossings_.push_back({piece.face, piece.patch, span.plane, piece.s0 + a * (piece.s1 - piece.s0),
                        piece.t0 + b * (piece.t1 - piece.t0)});
  // The Jacobian has the sign of dx / da along the cut times that of dy / db: the ends tell it even of a sliver.
  const bool positive = ((span.a1 > span.a0) == piece.rising) != piece.transposed;
  const int64_t first = scene_.face_body_offsets[piece.face], last = scene_.face_body_offsets[piece.face + 1];
  if (first == last) sections_.report_uncapped(thread_, piece.face);
  for (int64_t k = first; k < last; ++k) {
    const Scene::BodyUse& use = scene_.face_bodies[k];
    const bool enters = (positive == sections_.views()[view].upright) == (use.outward > 0);
    borders_.push_back({int32_t(view), use.body, span.plane, x, enters ? 1 : -1});
  }
}

void SectionCuts::remove(const Piece& piece, std::vector<Span>& spans) {
  if (spans.empty()) return;
  const Sections::Side side = sections_.side(piece.net);
  if (side == Sections::Side::kept) return;
  kept_.clear();
  if (side == Sections::Side::cut) {
    for (const Span& span : spans) split(piece, span, kept_);
  }
  spans.swap(kept_);
}

// Splits a span where the section planes cross it, and at the picture's borders, and keeps the stretches whose middles
// they do not remove.
void SectionCuts::split(const Piece& piece, const Span& span, std::vector<Span>& out) {
  stops_.clear();
  const auto before = [](const Crossing& p, const Crossing& q) {
    return std::tie(p.face, p.patch, p.plane) < std::tie(q.face, q.patch, q.plane);
  };
  const auto [first, last] = std::equal_range(crossings_.begin(), crossings_.end(),
                                              Crossing{piece.face, piece.patch, span.plane, 0, 0}, before);
  const auto inside = [](double c) { return c >= -kBorderRoom && c <= 1.0 + kBorderRoom; };
  for (auto crossing = first; crossing != last; ++crossing) {
    double a = (crossing->s - piece.s0) / (piece.s1 - piece.s0), b = (crossing->t - piece.t0) / (piece.t1 - piece.t0);
    if (piece.transposed) std::swap(a, b);
    const double progress = (a - span.a0) / (span.a1 - span.a0);
    if (inside(a) && inside(b) && progress > 0.0 && progress < 1.0) stops_.push_back({progress, a, b});
  }
  // Beyond the picture's borders a side view does not show all crossings: what lies there is judged by itself.
  for (const double border : {0.0, double(sections_.camera().width)}) {
    if (!(span.x0 < border && border < span.x1)) continue;
    const double share = (border - span.x0) / (span.x1 - span.x0);
    SurfaceSample sample{span.a0 + share * (span.a1 - span.a0), span.b0 + share * (span.b1 - span.b0), {}};
    solve_sample(span, border, span.y, &sample);
    const double progress = (sample.a - span.a0) / (span.a1 - span.a0);
    if (progress > 0.0 && progress < 1.0) stops_.push_back({progress, sample.a, sample.b});
  }
  std::sort(stops_.begin(), stops_.end(), [](const Stop& p, const Stop& q) { return p.progress < q.progress; });
  CutPoint from{span.a0, span.b0, span.x0, span.key0, span.fold0};
  const auto add = [&](const CutPoint& to) {
    const double a = 0.5 * (from.a + to.a);
    const double b = piece.kind == CutKind::uncertain ? from.b : cut_at(piece, span.y, a, 0.5 * (from.b + to.b));
    if (from.x < to.x && !sections_.removes(evaluate(piece.net, a, b).p)) {
      const Interval key = span.key_between(from.a, from.key, to.a, to.key);
      Span part = span;
      part.x0 = from.x, part.a0 = from.a, part.b0 = from.b, part.key0 = from.key, part.fold0 = from.fold;
      part.x1 = to.x, part.a1 = to.a, part.b1 = to.b, part.key1 = to.key, part.fold1 = to.fold;
      part.nearest = std::max(key.lo, span.nearest), part.farthest = std::min(key.hi, span.farthest);
      out.push_back(part);
    }
    from = to;
  };
  for (const Stop& stop : stops_) {
    CutPoint point = point_of(piece, stop.a, std::clamp(stop.b, 0.0, 1.0));
    point.x = std::clamp(point.x, from.x, span.x1);
    add(point);
  }
  add({span.a1, span.b1, span.x1, span.key1, span.fold1});
}

// The caps of all bodies, from what their outlines bound on each scan plane.
void SectionCuts::make_caps(const double* y) {
  cap_spans_.clear(), caps_.clear();
  std::sort(borders_.begin(), borders_.end(), [](const Border& p, const Border& q) {
    return std::tie(p.view, p.body, p.plane, p.x) < std::tie(q.view, q.body, q.plane, q.x);
  });
  std::vector<std::size_t> starts;  // of each cap's spans
  for (std::size_t first = 0, last = 0; first < borders_.size(); first = last) {
    const Border& border = borders_[first];
    while (last < borders_.size() && borders_[last].view == border.view && borders_[last].body == border.body) ++last;
    if (sections_.views()[border.view].edge_on) continue;
    const std::size_t start = cap_spans_.size();
    find_runs(first, last, y);
    if (cap_spans_.size() > start) starts.push_back(start);
  }
  starts.push_back(cap_spans_.size());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    caps_.push_back({cap_spans_.data() + starts[k], cap_spans_.data() + starts[k + 1]});
  }
}

// Fills the cap with the borders [first, last), scan plane by scan plane. Where an outline has a gap (edges of
// neighbouring faces may miss each other by the file's tolerance) the nearest plane without one stands in.
void SectionCuts::find_runs(std::size_t first, std::size_t last, const double* y) {
  runs_.clear();
  for (std::size_t k = first; k < last;) {
    Run run{k, k, false};
    while (run.last < last && borders_[run.last].plane == borders_[k].plane) ++run.last;
    k = run.last;
    run.closed = is_closed(run);
    runs_.push_back(run);
  }
  const auto plane_of = [&](const Run& run) { return borders_[run.first].plane; };
  for (const Run& run : runs_) {
    const int32_t plane = plane_of(run);
    const Run* shown = &run;
    if (!run.closed) {
      sections_.report_gap(thread_);
      double nearest = kNeighbour;
      for (const Run& other : runs_) {
        const double distance = std::fabs(y[plane_of(other)] - y[plane]);
        if (other.closed && distance < nearest) nearest = distance, shown = &other;
      }
    }
    fill(*shown, plane, y[plane]);
  }
}

// The winding number left of the run's borders. It is 0 at the horizon, which is on the left if what is near is right.
int SectionCuts::winding_before(const Run& run) const {
  const SectionView& view = sections_.views()[borders_[run.first].view];
  if (view.whole || view.side.near_right) return 0;
  int sum = 0;
  for (std::size_t k = run.first; k < run.last; ++k) sum += borders_[k].winds;
  return -sum;
}

// Whether the run is that of a closed outline: entered as often as left. Behind the eye no borders are known.
bool SectionCuts::is_closed(const Run& run) const {
  int sum = 0;
  for (std::size_t k = run.first; k < run.last; ++k) sum += borders_[k].winds;
  return sum == 0 || (!sections_.views()[borders_[run.first].view].whole && std::abs(sum) == 1);
}

// Adds the spans of a cap on a scan plane: where the winding number is not 0, or, on an outline with a gap, between
// two neighbouring borders that both say so.
void SectionCuts::fill(const Run& run, int32_t plane, double y) {
  const Border& of = borders_[run.first];
  int winding = winding_before(run);
  if (run.closed && winding != 0) fill_stretch(of, -INFINITY, of.x, plane, y);
  for (std::size_t k = run.first; k < run.last; ++k) {
    winding += borders_[k].winds;
    const bool ends = k + 1 == run.last;
    if (run.closed && winding != 0) {
      fill_stretch(of, borders_[k].x, ends ? INFINITY : borders_[k + 1].x, plane, y);
    } else if (!run.closed && !ends && borders_[k].winds > 0 && borders_[k + 1].winds < 0) {
      fill_stretch(of, borders_[k].x, borders_[k + 1].x, plane, y);
    }
  }
}

// Adds the stretch [x0, x1] of a cap as far as the other section planes and the picture leave it.
void SectionCuts::fill_stretch(const Border& of, double x0, double x1, int32_t plane, double y) {
  const Piece& cap = sections_.cap(of.view, of.body);
  const Interval clipped = sections_.kept_stretch(of.view, intersect({x0, x1}, cap.hull.x), y);
  if (!(clipped.lo < clipped.hi)) return;
  const auto a = [&](double x) { return (x - cap.hull.x.lo) / cap.hull.x.width(); };
  const double b = (y - cap.hull.y.lo) / cap.hull.y.width();
  const double key0 = cap.hull.plane.key(clipped.lo, y), key1 = cap.hull.plane.key(clipped.hi, y);
  cap_spans_.push_back({&cap, y, clipped.lo, clipped.hi, a(clipped.lo), b, a(clipped.hi), b, key0, key1,
                        std::min(key0, key1), std::max(key0, key1), plane, false, false, 0});
}

}  // namespace nofacet
