#include "parallel.h"

#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>

namespace nofacet {
namespace {

// One call of run_on_threads.
struct Job {
  const std::function<void(int)>& work;
  int threads;
  int next = 1;     // the next of the other threads to begin
  int running = 0;  // other threads that have begun and not returned
};

// Threads that wait for jobs. They never end, so it is never destroyed.
class Helpers {
 public:
  // Those of this process: a forked one has none of its parent's.
  static Helpers& of_process() {
    static std::atomic<Helpers*> current{new Helpers};
    Helpers* helpers = current.load();
    while (helpers->process_ != getpid()) {
      auto* fresh = new Helpers;
      if (current.compare_exchange_strong(helpers, fresh)) return *fresh;
      delete fresh;
    }
    return *helpers;
  }

  void run(Job& job) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(&job);
      wanted_ += job.threads - 1;
      add_idle();
    }
    if (job.threads == 2) {
      wake_.notify_one();
    } else {
      wake_.notify_all();
    }
    job.work(0);
    std::unique_lock lock(mutex_);
    if (job.next < job.threads) withdraw(job);
    returned_.wait(lock, [&] { return job.running == 0; });
  }

 private:
  void add_idle() {
    try {
      for (; idle_ < wanted_; ++idle_) std::thread(&Helpers::help, this).detach();
    } catch (const std::system_error&) {
      // The system gives no more: fewer will do.
    }
  }

  void help() {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [&] { return !jobs_.empty(); });
      Job& job = *jobs_.front();
      const int thread = job.next++;
      ++job.running, --idle_, --wanted_;
      if (job.next == job.threads) jobs_.pop_front();
      lock.unlock();
      job.work(thread);
      lock.lock();
      ++idle_;
      if (--job.running == 0) returned_.notify_all();
    }
  }

  // No more threads are to begin with the job.
  void withdraw(const Job& job) {
    wanted_ -= job.threads - job.next;
    jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
  }

  const pid_t process_ = getpid();
  std::mutex mutex_;
  std::condition_variable wake_, returned_;
  std::deque<Job*> jobs_;  // that more threads are to begin with
  int idle_ = 0;           // helpers without a job
  int wanted_ = 0;         // helpers that jobs_ would take
};

}  // namespace

void run_on_threads(int threads, const std::function<void(int)>& work) {
  if (threads < 2) return work(0);
  Job job{work, threads};
  Helpers::of_process().run(job);
}

}  // namespace nofacet
