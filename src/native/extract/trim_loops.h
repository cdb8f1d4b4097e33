// Closed trim loops of many faces: put together from edge uses, measured, welded.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// Rational Bezier segments (wu, wv, w) with end weights 1: segment k has degree[k] + 1 points from first_point[k] on.
struct SegmentView {
  const int64_t *first_point, *degree;
  const double* points;  // (points, 3)
};

// Loops of segments, ordered by face, before their joints are welded. Entry k of a loop is segment[k] of the table, run
// backwards or not, with shift[k] added to its (u, v); edge[k] is what it runs along.
struct RunView {
  std::size_t loops;
  const int64_t *face, *loop_offsets;  // (loops,), (loops + 1,)
  const int64_t* segment;              // (entries,)
  const bool* backwards;
  const double* shift;  // (entries, 2)
  const int64_t* edge;
  SegmentView table;

  std::size_t entries() const { return std::size_t(loop_offsets[loops]); }
};

// Welded loops: every segment starts bitwise where the one before it ends.
struct LoopTable {
  std::vector<int64_t> face, loop_offsets{0}, segment_offsets{0};
  std::vector<double> points;  // (points, 3)
  std::vector<int32_t> edge;
};

struct LoopView {
  std::size_t loops;
  const int64_t *face, *loop_offsets, *segment_offsets;
  const double* points;
};

// u0, u1, v0, v1 of each face's loops (faces, 4), NaN without any: exact for straight segments, at most 1/200 of a
// segment's own hull too wide else.
std::vector<double> bounding_boxes(const RunView& runs, std::size_t faces);

// The entries behind which there is a gap that may be a corner (corners.h); boxes: (faces, 4).
std::vector<int64_t> corner_gaps(const RunView& runs, const double* boxes);

// The loops of the faces that are `kept` (faces,), closed: small gaps are moved away, corners made, other gaps get a
// straight link. at_pole: (entries,), whether the joint behind an entry is on a line that is one point in space. Boxes
// of faces with corners are brought up to date.
LoopTable close_loops(const RunView& runs, const bool* kept, const bool* at_pole, double* boxes);

// Whether each face's loops are one loop once around its box, every segment on one of the box's sides.
std::vector<uint8_t> rectangles(const LoopView& loops, const double* boxes, std::size_t faces);

}  // namespace nofacet
