// Memory for many short-lived lists of numbers.
#pragma once
#include <cstddef>
#include <vector>

#include "arena.h"

namespace nofacet {

// What is given back is taken anew, the last first, while it is still in the caches. A block may be given back to
// another pool than it came from; all live until the pools they came from are gone.
class BlockPool {
 public:
  // Room for `count` numbers, not initialized.
  double* take(std::size_t count) {
    std::vector<double*>& idle = idle_of(count);
    if (idle.empty()) return arena_.take(steps(count) * kStep);
    double* block = idle.back();
    idle.pop_back();
    return block;
  }
  // `count`: as it was taken.
  void give_back(double* block, std::size_t count) { idle_of(count).push_back(block); }

 private:
  static constexpr std::size_t kStep = 64;  // sizes are multiples of it

  static std::size_t steps(std::size_t count) { return (count + kStep - 1) / kStep; }
  std::vector<double*>& idle_of(std::size_t count) {
    if (steps(count) >= idle_.size()) idle_.resize(steps(count) + 1);
    return idle_[steps(count)];
  }

  Arena<double> arena_;
  std::vector<std::vector<double*>> idle_;  // by their steps
};

}  // namespace nofacet
