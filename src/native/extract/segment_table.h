// The segments of many edge uses as one table.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// Segments of one degree. owner: (count,), the use that each belongs to, ascending; points: (count, degree + 1, 3).
struct PieceView {
  std::size_t count;
  int degree;
  const int64_t* owner;
  const double* points;
};

// Use k has the segments offsets[k] .. offsets[k + 1]; segment s has degree[s] + 1 points from first_point[s] on.
struct SegmentTable {
  std::vector<int64_t> offsets, first_point, degree;
  std::vector<double> points;  // (points, 3)
};

// The pieces of `uses` uses, all of one use being in one of the views.
SegmentTable segment_table(const std::vector<PieceView>& parts, std::size_t uses);

}  // namespace nofacet
