#pragma once

#include <cstddef>
#include <exception>
#include <functional>

namespace osteomill {

/// Thrown to cancel long work.
struct WorkStopped : std::exception {
  const char* what() const noexcept override { return "cancelled"; }
};

/// Reports the progress of long work in this thread (reading a scan, meshing it, preparing an algorithm) to a
/// listener, as long as this object exists. The haptic tick reports nothing. The work reports at least about
/// every 0.1 s; to cancel it, throw WorkStopped from the listener, which ends the work and frees its memory.
class WorkProgress {
 public:
  /// Called often, in this thread, with the completed share of the whole, 0 to 1, never decreasing.
  using Listener = std::function<void(double share_done)>;
  explicit WorkProgress(Listener listener);
  ~WorkProgress();
  WorkProgress(const WorkProgress&) = delete;
  WorkProgress& operator=(const WorkProgress&) = delete;

  /// Reports the completed share (0 to 1) of the work. Called by the work; does nothing without a listener.
  static void done(double share);
  /// Reports the number of completed parts.
  static void done(std::size_t parts, std::size_t of_parts) {
    done(of_parts > 0 ? static_cast<double>(parts) / static_cast<double>(of_parts) : 1);
  }

  /// One part of a larger task: progress reported while this object exists is mapped to the range from the
  /// end of the previous part to `until`, a share of the larger task. Its destructor marks the part
  /// completed, unless an exception ended it.
  class Part {
   public:
    explicit Part(double until);
    ~Part();
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    double whole_from_;
    double whole_to_;
    int exceptions_;
  };

  /// Returns a listener for a WorkProgress in another thread that this thread waits for; it forwards that
  /// thread's progress to this thread's listener.
  static Listener of_this_thread();

 private:
  // The range of the whole that the current part covers, and the progress of the whole.
  struct Work {
    Listener* listener = nullptr;
    double from = 0;
    double to = 1;
    double at = 0;
  };
  static thread_local Work work_;

  Listener listener_;
  // The enclosing work, restored by the destructor.
  Work outer_;
};

}  // namespace osteomill
