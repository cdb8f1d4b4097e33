// Intervals cut into equal pieces.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// Pieces, by interval and ascending. owner: the interval; start, stop: the piece's ends.
struct Cuts {
  std::vector<int64_t> owner;
  std::vector<double> start, stop;
};

// Each interval [low[k], high[k]] in equal pieces of at most `limit`; a billionth of a piece too many is none. Never
// more than 10,000 pieces, and one where the ends are no numbers: damaged files have such intervals.
Cuts cut_evenly(std::size_t count, const double* low, const double* high, double limit);

}  // namespace nofacet
