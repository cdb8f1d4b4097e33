// The order of a wire's edge uses, where it is plain.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/trim_loops.h"

namespace nofacet {

// Where the uses of edges begin and end in (u, v), and the extents of their wires, nowhere zero, by the ends of the
// wires' segments; all (count, 2).
struct UseEnds {
  std::vector<double> start, end, size;
};

// The ends of uses, ordered by wire. Use k has segments offsets[k] .. offsets[k + 1] of the table, and its wire runs
// against them if reversed[k].
UseEnds use_ends(std::size_t count, const int64_t* wire, const bool* reversed, const int64_t* offsets,
                 const SegmentView& table);

// Uses of edges, ordered by wire. start, end: (count, 2), where each begins and ends in (u, v); size: (count, 2), the
// extent of its wire.
struct UseView {
  std::size_t count;
  const int64_t* wire;
  const double *start, *end, *size;
};

// Uses in the order of their loops, with the number of each one's loop; wires left out.
struct UseOrder {
  std::vector<int64_t> use, loop, unclear;
};

// Real wires store their edges backwards or in any order. The order is plain where each use starts where the one before
// it ends, or where every end meets exactly one other's start.
UseOrder order_uses(const UseView& uses);

}  // namespace nofacet
