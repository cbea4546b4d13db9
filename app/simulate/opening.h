#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <vector>

#include "app/simulate/simulation.h"

namespace osteomill::app {

/// A scan that is being opened on a thread of its own, and can be stopped. What was stopped ends by itself
/// within about a tenth of a second and gives its memory back; only the end of this object waits for it.
class Opening {
 public:
  Opening() = default;
  ~Opening() { stop(); }
  Opening(const Opening&) = delete;
  Opening& operator=(const Opening&) = delete;

  /// Stops what is being opened, and begins another.
  void begin(std::function<OpenedScan()> open);
  void stop();

  bool valid() const { return result_.valid(); }
  std::future_status wait_for(std::chrono::milliseconds time) const { return result_.wait_for(time); }
  /// Once. Throws what opening threw.
  OpenedScan get() { return result_.get(); }
  /// Of all that opening does.
  double share_done() const { return work_ ? work_->share_done.load() : 0; }

 private:
  struct Work {
    std::atomic<double> share_done = 0;
    std::atomic<bool> stopped = false;
  };
  std::shared_ptr<Work> work_;
  std::future<OpenedScan> result_;
  std::vector<std::future<OpenedScan>> stopped_;
};

}  // namespace osteomill::app
