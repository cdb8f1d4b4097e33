#include "raster/plane_cut.h"

#include <algorithm>

namespace nofacet {
namespace {

void merge_covered(const PlaneCut& cut, double width, std::vector<Interval>& out) {
  out.clear();
  for (const VisibleSegment& segment : cut.segments) out.push_back({segment.x0, segment.x1});
  if (!cut.transparent.empty()) {
    for (const Span& span : cut.transparent) out.push_back({std::max(span.x0, 0.0), std::min(span.x1, width)});
    std::sort(out.begin(), out.end(), [](const Interval& p, const Interval& q) { return p.lo < q.lo; });
  }
  std::size_t kept = 0;
  for (const Interval& next : out) {
    // Neighbouring faces meet but for rounding.
    if (kept > 0 && next.lo <= out[kept - 1].hi + kSliverPixels) {
      out[kept - 1].hi = std::max(out[kept - 1].hi, next.hi);
    } else {
      out[kept++] = next;
    }
  }
  out.resize(kept);
}

}  // namespace

void PlaneCut::intersect(const std::vector<const Piece*>& pieces, double plane_y, const Scene& scene,
                         const Camera& camera, double tie) {
  y = plane_y;
  opaque.clear();
  for (const Piece* piece : pieces) {
    if (piece->y.lo <= y && y <= piece->y.hi) append_spans(*piece, y, camera, opaque);
  }
  const float* color = scene.model.face_color;
  const auto middle = std::stable_partition(opaque.begin(), opaque.end(), [&](const Span& span) {
    return color[4 * std::size_t(span.piece->face) + 3] >= 1.0f;
  });
  transparent.assign(middle, opaque.end());
  opaque.erase(middle, opaque.end());
  resolve_visibility(opaque, camera, tie, segments);
  merge_covered(*this, camera.width, covered);
}

double longest_difference(const PlaneCut& p, const PlaneCut& q) {
  double longest = 0.0, x = 0.0;
  bool in_p = false, in_q = false;
  std::size_t k = 0, l = 0;  // next border of p and q: even index enters, odd leaves
  const auto border = [](const std::vector<Interval>& list, std::size_t index) {
    return index % 2 == 0 ? list[index / 2].lo : list[index / 2].hi;
  };
  while (k < 2 * p.covered.size() || l < 2 * q.covered.size()) {
    const bool from_p =
        l >= 2 * q.covered.size() || (k < 2 * p.covered.size() && border(p.covered, k) <= border(q.covered, l));
    const double next = from_p ? border(p.covered, k) : border(q.covered, l);
    if (in_p != in_q) longest = std::max(longest, next - x);
    x = next;
    if (from_p) {
      in_p = !in_p, ++k;
    } else {
      in_q = !in_q, ++l;
    }
  }
  return longest;
}

}  // namespace nofacet
