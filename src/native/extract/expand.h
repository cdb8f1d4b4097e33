// Runs of numbers written out.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// owner: the run of each number; number: run k's, start[k] .. start[k] + count[k] - 1, behind those of the runs before.
struct Expanded {
  std::vector<int64_t> owner, number;
};

// Throws std::invalid_argument for a run of negative length.
Expanded expand(const int64_t* start, const int64_t* count, std::size_t runs);

}  // namespace nofacet
