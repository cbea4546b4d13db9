#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace osteomill {

/// A queue of fixed capacity from one thread to one other. Both ends are safe in the haptic tick (no
/// allocation, lock or system call) where moving a T is. Made and destroyed while neither thread uses it.
template <typename T>
class SpscRing {
 public:
  explicit SpscRing(std::size_t capacity) : slots_(capacity + 1) {}

  /// For the sending thread: false, with `value` as it was, where the queue is full.
  bool try_push(T&& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = after(tail);
    if (next == head_.load(std::memory_order_acquire)) return false;
    slots_[tail] = std::move(value);
    tail_.store(next, std::memory_order_release);
    return true;
  }
  /// For the sending thread: whether the next push will succeed.
  bool has_room() const {
    return after(tail_.load(std::memory_order_relaxed)) != head_.load(std::memory_order_acquire);
  }
  /// For the receiving thread: the oldest value, or nothing.
  std::optional<T> try_pop() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return std::nullopt;
    std::optional<T> value(std::move(slots_[head]));
    head_.store(after(head), std::memory_order_release);
    return value;
  }

 private:
  std::size_t after(std::size_t place) const { return place + 1 == slots_.size() ? 0 : place + 1; }

  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace osteomill
