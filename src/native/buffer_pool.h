// Memory for frame buffers and arenas, kept for the next frame: fresh pages cost as much to fault in as to fill.
#pragma once
#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>

namespace nofacet {

class BufferPool {
 public:
  static constexpr std::size_t kPage = 1 << 21;  // a huge page; what is taken is a multiple of it, or a power of 2

  static BufferPool& instance() {
    static BufferPool* pool = new BufferPool;  // outlives every buffer, whatever the order of destruction at exit
    return *pool;
  }

  void* take(std::size_t bytes) {
    const std::size_t size = rounded(bytes);
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = idle_.find(size); found != idle_.end()) {
        void* memory = found->second;
        idle_.erase(found);
        idle_bytes_ -= size;
        return memory;
      }
    }
    void* memory = std::aligned_alloc(size < kPage ? kLine : kPage, size);
    if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (size >= kPage) madvise(memory, size, MADV_HUGEPAGE);
#endif
    return memory;
  }
  void give_back(void* memory, std::size_t bytes) {
    const std::size_t size = rounded(bytes);
    const std::lock_guard lock(mutex_);
    if (idle_bytes_ + size > kMostIdle) {
      std::free(memory);
      return;
    }
    idle_.emplace(size, memory);
    idle_bytes_ += size;
  }

  // Frees what is idle.
  void release() {
    const std::lock_guard lock(mutex_);
    for (const auto& [size, memory] : idle_) std::free(memory);
    idle_.clear();
    idle_bytes_ = 0;
  }

 private:
  static constexpr std::size_t kLine = 64;              // bytes of the caches
  static constexpr std::size_t kMostIdle = 512u << 20;  // bytes; two frames of 4K with all buffers

  static std::size_t rounded(std::size_t bytes) {
    return bytes < kPage ? std::bit_ceil(std::max(bytes, kLine)) : (bytes + kPage - 1) / kPage * kPage;
  }

  std::mutex mutex_;
  std::multimap<std::size_t, void*> idle_;
  std::size_t idle_bytes_ = 0;
};

}  // namespace nofacet
