// A trim loop made whole where neighbouring edges do not meet.
//
// Gaps of the size of rounding are moved away. Wider ones are corners that the two edges overshot or fell short of: a
// straight link between the ends would add or take away a triangle there. So the corner is looked for on both edges and
// on their tangents beyond the ends: a crossing of the edges themselves, else the crossing nearest to the two ends, if
// it is near at all. An edge is cut at the corner, or led on to it by a straight segment. Where there is none (edges
// that run on side by side, missing edges) the straight link remains.
#pragma once
#include <cstdint>
#include <vector>

namespace nofacet {

struct LoopPoint {
  double u, v, w;  // homogeneous

  bool operator==(const LoopPoint&) const = default;
};

// A rational Bezier segment with end weights 1.
struct TrimSegment {
  std::vector<LoopPoint> points;
  int64_t edge;  // what it runs along; -1 for none
  bool at_pole;  // whether the joint behind it is on a line of (u, v) that is one point in space: gaps stay straight
};
using TrimLoop = std::vector<TrimSegment>;

// Gaps up to this part of the face's box are rounding: the next segment's end is moved. Wider ones get a link.
inline constexpr double kSnap = 1e-9;
// Gaps below this part of the box stay straight: no picture shows them, and where curves all but touch, their crossing
// would be rounding. Gaps beyond the other part are missing edges, not corners.
inline constexpr double kNarrowestCorner = 1e-7, kWidestCorner = 0.1;

// The loop with neighbouring segments, the last and the first too, sharing their end points bitwise. width, height: the
// face's box.
TrimLoop weld(TrimLoop loop, double width, double height);

}  // namespace nofacet
