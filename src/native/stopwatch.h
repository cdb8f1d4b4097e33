// Wall-clock time, shared out between stages.
#pragma once
#include <chrono>

namespace nofacet {

class Stopwatch {
 public:
  // Adds the seconds since the last lap, or since the start, to `sum`.
  void lap(double& sum) {
    const Clock::time_point now = Clock::now();
    sum += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  void restart() { last_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace nofacet
