// Bump allocation with stable addresses; everything is freed together.
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

namespace nofacet {

template <class T>
class Arena {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  T* take(std::size_t count) {
    if (blocks_.empty() || used_ + count > capacity_) {
      capacity_ = std::max<std::size_t>(count, 1 << 15);
      blocks_.push_back(std::make_unique_for_overwrite<T[]>(capacity_));
      used_ = 0;
    }
    T* result = blocks_.back().get() + used_;
    used_ += count;
    return result;
  }

 private:
  std::vector<std::unique_ptr<T[]>> blocks_;
  std::size_t used_ = 0, capacity_ = 0;
};

}  // namespace nofacet
