#include "extract/distinct.h"

#include <bit>

namespace nofacet {

// A hash table with open addressing, at most half full; keys are spread by Fibonacci hashing (Knuth, TAOCP 3, 6.4).
Distinct distinct(const int64_t* keys, std::size_t count) {
  constexpr uint64_t kGoldenRatio = 0x9E3779B97F4A7C15;
  const int bits = std::bit_width(2 * count + 1);
  std::vector<int64_t> slots(std::size_t(1) << bits, -1);  // the number of the key that lies there, -1 for none
  Distinct result;
  result.number.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t slot = std::size_t(uint64_t(keys[k]) * kGoldenRatio >> (64 - bits));
    while (slots[slot] >= 0 && keys[result.first[std::size_t(slots[slot])]] != keys[k]) {
      slot = (slot + 1) & (slots.size() - 1);
    }
    if (slots[slot] < 0) {
      slots[slot] = int64_t(result.first.size());
      result.first.push_back(int64_t(k));
    }
    result.number.push_back(slots[slot]);
  }
  return result;
}

}  // namespace nofacet
