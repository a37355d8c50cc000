#include "headless/stability/test_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace collidoscope {

void run_tests(std::span<TestRun> test_runs, int jobs,
               const std::function<bool(std::int64_t done)>& on_progress, std::int64_t max_parallel_bodies) {
  std::atomic<std::size_t> next{0};
  std::atomic<std::int64_t> done{0};
  std::atomic<bool> stop{false};
  std::mutex mutex, large;
  std::condition_variable ended;
  const auto work = [&] {
    for (std::size_t k = next++; k < test_runs.size() && !stop; k = next++) {
      std::unique_lock one_at_a_time(large, std::defer_lock);
      if (test_runs[k].bodies() > max_parallel_bodies) one_at_a_time.lock();
      while (!stop && test_runs[k].advance(20))
        ;
      if (!stop) ++done;
      ended.notify_one();
    }
  };
  std::vector<std::jthread> team;
  for (std::size_t k = 0; k < std::min(static_cast<std::size_t>(jobs), test_runs.size()); ++k)
    team.emplace_back(work);
  while (done < std::ssize(test_runs) && !stop) {
    {
      std::unique_lock lock(mutex);
      ended.wait_for(lock, std::chrono::milliseconds(100));
    }
    if (!on_progress(done)) stop = true;
  }
}

}  // namespace collidoscope
