#pragma once

#include <array>
#include <atomic>
#include <type_traits>

namespace osteomill {

/// Passes the latest value from one writing thread to one reading thread without tearing. Triple-buffered:
/// each thread owns a buffer and they exchange the third. Neither side ever waits; both are safe in the
/// haptic tick if copying a T is.
template <typename T>
class LatestValue {
 public:
  /// Publishes a value. For the writing thread.
  void write(const T& value) noexcept(std::is_nothrow_copy_assignable_v<T>) {
    buffers_[writing_] = value;
    writing_ = shared_.exchange(writing_ | kNewFlag, std::memory_order_acq_rel) & kIndexMask;
  }
  /// Returns the latest value, or a default-constructed one before the first write. Valid until the next
  /// call. For the reading thread.
  const T& read() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kNewFlag) != 0) {
      reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & kIndexMask;
    }
    return buffers_[reading_];
  }

 private:
  static constexpr unsigned kIndexMask = 3;
  static constexpr unsigned kNewFlag = 4;

  std::array<T, 3> buffers_{};
  unsigned writing_ = 0;
  std::atomic<unsigned> shared_{1};
  unsigned reading_ = 2;
};

}  // namespace osteomill
