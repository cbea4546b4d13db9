#include "app/simulate/opening.h"

#include "app/memory_limit.h"
#include <malloc.h>

#include "osteomill/numbers/work_progress.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;

}  // namespace

void Opening::begin(std::function<OpenedScan()> open) {
  stop();
  work_ = std::make_shared<Work>();
  result_ = std::async(std::launch::async, [work = work_, open = std::move(open)] {
    try {
      const WorkProgress progress([&](double share) {
        work->share_done = share;
        if (work->stopped) throw WorkStopped();
        check_memory_taken();
      });
      return open();
    } catch (const WorkStopped&) {
#ifdef __GLIBC__
      ::malloc_trim(0);
#endif
      throw;
    }
  });
}

void Opening::stop() {
  std::erase_if(stopped_, [](const auto& ended) { return ended.wait_for(0s) == std::future_status::ready; });
  if (!result_.valid()) return;
  work_->stopped = true;
  stopped_.push_back(std::move(result_));
}

}  // namespace osteomill::app
