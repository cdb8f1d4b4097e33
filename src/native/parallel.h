// A loop over independent tasks on several threads, handed out one at a time.
#pragma once
#include <atomic>
#include <cstddef>
#include <functional>

namespace nofacet {

// Calls work(0) on this thread and work(1) .. work(threads - 1) on others, as far as these come before work(0) has
// returned; all have returned then. The other threads are made when they are first needed and wait for the next call.
// Any number of threads may call it at the same time; what is called must not throw.
void run_on_threads(int threads, const std::function<void(int)>& work);

// Calls body(task, thread) for every task in [0, count). Results must not depend on which thread runs a task.
// Once `cancel` (may be null) is true no further task is begun.
template <class Body>
void parallel_for(std::size_t count, int threads, Body&& body, const std::atomic<bool>* cancel = nullptr) {
  std::atomic<std::size_t> next{0};
  const auto work = [&](int thread) {
    for (std::size_t task; !(cancel && cancel->load()) && (task = next.fetch_add(1)) < count;) body(task, thread);
  };
  run_on_threads(count < std::size_t(threads) ? int(count) : threads, work);
}

}  // namespace nofacet
