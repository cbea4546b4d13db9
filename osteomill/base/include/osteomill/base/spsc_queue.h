#pragma once

#include <cstddef>
#include <utility>

#include <readerwriterqueue/readerwriterqueue.h>
#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
extern "C" void __tsan_ignore_thread_begin();
extern "C" void __tsan_ignore_thread_end();
#endif

namespace osteomill {

/// A queue of fixed capacity from one thread to one other (single producer, single consumer; moodycamel's,
/// made known to the thread sanitizer). Both ends are safe in the haptic tick (no allocation, lock or system
/// call) if making and moving a T is. It is made and destroyed while neither thread uses it.
template <typename T>
class SpscQueue {
 public:
  /// Makes room for `capacity` values or a few more. Touches all its memory, so that no tick is the first to.
  explicit SpscQueue(std::size_t capacity) : queue_(capacity) {
    while (queue_.try_enqueue(T())) {
    }
    while (queue_.pop()) {
    }
  }

  /// Makes a value at its place in the queue. Returns false, with nothing made or moved from, if the queue is
  /// full. For the sending thread.
  template <typename... From>
  bool try_push(From&&... from) {
    const Access access(&queue_);
    return queue_.try_emplace(std::forward<From>(from)...);
  }
  /// Takes out the oldest value; returns false if there is none. For the receiving thread.
  bool try_pop(T& value) {
    const Access access(&queue_);
    return queue_.try_dequeue(value);
  }
  /// Returns the oldest value at its place, valid until `pop`; null if there is none. For the receiving
  /// thread.
  T* front() {
    const Access access(&queue_);
    return queue_.peek();
  }
  /// Takes out the oldest value, if there is one. For the receiving thread.
  void pop() {
    const Access access(&queue_);
    queue_.pop();
  }

 private:
  // The thread sanitizer does not know the fences by which the queue orders its places. It is told to leave
  // them alone, and that what was written before a value went in is seen by who took it out.
  class Access {
   public:
    explicit Access([[maybe_unused]] void* queue) {
#ifdef __SANITIZE_THREAD__
      queue_ = queue;
      __tsan_release(queue_);
      __tsan_ignore_thread_begin();
#endif
    }
    ~Access() {
#ifdef __SANITIZE_THREAD__
      __tsan_ignore_thread_end();
      __tsan_acquire(queue_);
#endif
    }
    Access(const Access&) = delete;
    Access& operator=(const Access&) = delete;

   private:
#ifdef __SANITIZE_THREAD__
    void* queue_;
#endif
  };

  moodycamel::ReaderWriterQueue<T> queue_;
};

}  // namespace osteomill
