// A loop over independent tasks on several threads, handed out one at a time.
#pragma once
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace nofacet {

// Calls body(task, thread) for every task in [0, count). Results must not depend on which thread runs a task.
// Once `cancel` (may be null) is true no further task is begun.
template <class Body>
void parallel_for(std::size_t count, int threads, Body&& body, const std::atomic<bool>* cancel = nullptr) {
  std::atomic<std::size_t> next{0};
  auto work = [&](int thread) {
    for (std::size_t task; !(cancel && cancel->load()) && (task = next.fetch_add(1)) < count;) body(task, thread);
  };
  std::vector<std::jthread> pool;
  for (int k = 1; k < threads && std::size_t(k) < count; ++k) pool.emplace_back(work, k);
  work(0);
}

}  // namespace nofacet
