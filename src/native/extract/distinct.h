// Equal keys found and numbered.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// first: where each distinct key stands first, ascending; number: (keys,), the place of each key's own in `first`.
struct Distinct {
  std::vector<int64_t> first, number;
};

// Numbers keys in the order of their first appearance.
Distinct distinct(const int64_t* keys, std::size_t count);

}  // namespace nofacet
