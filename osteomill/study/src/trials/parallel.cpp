#include "osteomill/study/parallel.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

// Calls `work`. Returns its exception, or null.
template <typename Work>
std::exception_ptr exception_of(const Work& work) {
  try {
    work();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

void run_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& done) {
  std::mutex mutex;
  std::size_t next = 0;
  std::size_t finished = 0;
  std::exception_ptr fault;
  const auto work = [&] {
    std::unique_lock lock(mutex);
    while (next < count && !fault) {
      const std::size_t mine = next++;
      lock.unlock();
      const std::exception_ptr mine_failed = exception_of([&] { task(mine); });
      lock.lock();
      if (!fault) fault = mine_failed;
      if (!fault) fault = exception_of([&] { done(++finished); });
    }
  };
  const WorkProgress::Listener progress = WorkProgress::of_this_thread();
  const auto work_beside = [&] {
    const WorkProgress here(progress);
    work();
  };
  std::vector<std::jthread> others;
  try {
    for (std::size_t n = 1; n < std::min(threads, count); ++n) others.emplace_back(work_beside);
  } catch (const std::system_error&) {
    // Continues with fewer threads.
  }
  work();
  others.clear();
  if (fault) std::rethrow_exception(fault);
}

}  // namespace osteomill
