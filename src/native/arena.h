// Bump allocation with stable addresses; everything is freed, or used anew, together.
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#include "buffer_pool.h"

namespace nofacet {

// For types without destructors that matter: what is taken is not initialized.
template <class T>
class Arena {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  T* take(std::size_t count) {
    while (block_ < blocks_.size() && used_ + count > blocks_[block_].capacity) ++block_, used_ = 0;
    if (block_ == blocks_.size()) add_block(count);
    T* result = reinterpret_cast<T*>(blocks_[block_].memory.get()) + used_;
    used_ += count;
    return result;
  }
  // Takes back the last `count` of what was taken last.
  void give_back(std::size_t count) { used_ -= count; }
  // Forgets what was taken and keeps the memory.
  void reuse() { block_ = used_ = 0; }

 private:
  // Blocks double up to a huge page.
  static constexpr std::size_t kFirstBytes = 1 << 16, kLargestBytes = BufferPool::kPage;

  struct Release {
    std::size_t bytes = 0;

    void operator()(std::byte* memory) const { BufferPool::instance().give_back(memory, bytes); }
  };
  struct Block {
    std::unique_ptr<std::byte[], Release> memory;
    std::size_t capacity;
  };

  void add_block(std::size_t count) {
    const std::size_t usual = std::min(kFirstBytes << std::min<std::size_t>(blocks_.size(), 16), kLargestBytes);
    const std::size_t bytes = std::max(usual, count * sizeof(T));
    void* memory = BufferPool::instance().take(bytes);
    blocks_.push_back({{static_cast<std::byte*>(memory), Release{bytes}}, bytes / sizeof(T)});
  }

  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;
};

}  // namespace nofacet
