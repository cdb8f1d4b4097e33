// Bump allocation with stable addresses; everything is freed, or used anew, together.
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
    while (block_ < blocks_.size() && used_ + count > blocks_[block_].capacity) ++block_, used_ = 0;
    if (block_ == blocks_.size()) {
      const std::size_t capacity = std::max<std::size_t>(count, (1 << 18) / sizeof(T));
      blocks_.push_back({std::make_unique_for_overwrite<T[]>(capacity), capacity});
    }
    T* result = blocks_[block_].data.get() + used_;
    used_ += count;
    return result;
  }
  // Forgets what was taken and keeps the memory.
  void reuse() { block_ = used_ = 0; }

 private:
  struct Block {
    std::unique_ptr<T[]> data;
    std::size_t capacity;
  };
  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;
};

}  // namespace nofacet
