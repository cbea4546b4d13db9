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

/// Queue of fixed capacity, single producer, single consumer (moodycamel's, annotated for the thread
/// sanitizer). Both ends are safe in the haptic tick (no allocation, lock or system call) if constructing and
/// moving a T is. Construct and destroy it while neither thread uses it.
template <typename T>
class SpscQueue {
 public:
  /// Reserves space for at least `capacity` values. Touches all its memory, so that no tick causes a page
  /// fault.
  explicit SpscQueue(std::size_t capacity) : queue_(capacity) {
    while (queue_.try_enqueue(T())) {
    }
    while (queue_.pop()) {
    }
  }

  /// Constructs a value in place. Returns false, without constructing or moving anything, if the queue is
  /// full. For the producer.
  template <typename... From>
  bool try_push(From&&... from) {
    const Access access(&queue_);
    return queue_.try_emplace(std::forward<From>(from)...);
  }
  /// Pops the oldest value; returns false if the queue is empty. For the consumer.
  bool try_pop(T& value) {
    const Access access(&queue_);
    return queue_.try_dequeue(value);
  }
  /// Returns the oldest value in place, valid until `pop`; null if the queue is empty. For the consumer.
  T* front() {
    const Access access(&queue_);
    return queue_.peek();
  }
  /// Discards the oldest value, if any. For the consumer.
  void pop() {
    const Access access(&queue_);
    queue_.pop();
  }

 private:
  // The thread sanitizer does not understand the fences that order the queue's slots. Makes it ignore them,
  // and declares that writes before a push are visible after the pop.
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
