#include "extract/expand.h"

#include <stdexcept>

namespace nofacet {

Expanded expand(const int64_t* start, const int64_t* count, std::size_t runs) {
  std::size_t total = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    if (count[run] < 0) throw std::invalid_argument("a run of negative length");
    total += std::size_t(count[run]);
  }
  Expanded result;
  result.owner.reserve(total);
  result.number.reserve(total);
  for (std::size_t run = 0; run < runs; ++run) {
    for (int64_t k = 0; k < count[run]; ++k) {
      result.owner.push_back(int64_t(run));
      result.number.push_back(start[run] + k);
    }
  }
  return result;
}

}  // namespace nofacet
