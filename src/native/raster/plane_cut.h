// Everything one scan plane meets: the spans of all pieces and what of them is visible.
#pragma once
#include <cstdint>
#include <vector>

#include "raster/scan_cut.h"
#include "raster/visibility.h"

namespace nofacet {

struct PlaneCut {
  double y = 0.0;
  std::vector<Span> opaque, transparent;
  std::vector<VisibleSegment> segments;  // nearest opaque spans, disjoint, ascending in x
  std::vector<Interval> covered;         // x covered by anything: disjoint, ascending

  PlaneCut() = default;
  PlaneCut(const PlaneCut&) = delete;  // segments look into the spans
  PlaneCut& operator=(const PlaneCut&) = delete;
  PlaneCut(PlaneCut&&) = default;

  // Cuts the pieces and resolves which opaque spans are visible. `pieces`: in a fixed order.
  void intersect(const std::vector<const Piece*>& pieces, double plane_y, const Scene& scene, const Camera& camera,
                 double tie);
};

// Length of the longest stretch of x that one of the two planes covers and the other does not.
double longest_difference(const PlaneCut& p, const PlaneCut& q);

}  // namespace nofacet
