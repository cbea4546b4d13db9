#pragma once

#include <cstddef>
#include <exception>
#include <functional>

namespace osteomill {

/// Thrown to end long work that is no longer wanted.
struct WorkStopped : std::exception {
  const char* what() const noexcept override { return "stopped, since it is no longer wanted"; }
};

/// Reports to its listener, as long as it lives, how far the long work of this thread is: reading a scan,
/// meshing it, preparing an algorithm. The haptic tick reports nothing. The work reports at least about every
/// tenth of a second; to stop it, throw WorkStopped from the listener, which ends the work and frees its
/// memory.
class WorkProgress {
 public:
  /// Called often, in this thread, with the share done of the whole, from 0 to 1 and never falling.
  using Listener = std::function<void(double share_done)>;
  explicit WorkProgress(Listener listener);
  ~WorkProgress();
  WorkProgress(const WorkProgress&) = delete;
  WorkProgress& operator=(const WorkProgress&) = delete;

  /// Reports that this share (0 to 1) of the work is done. Called by the work; does nothing if no listener is
  /// set.
  static void done(double share);
  /// Reports that this many of the work's parts are done.
  static void done(std::size_t parts, std::size_t of_parts) {
    done(of_parts > 0 ? static_cast<double>(parts) / static_cast<double>(of_parts) : 1);
  }

  /// Marks one piece of a larger work: all that is done while it lives counts from the end of the piece
  /// before it to `until`, a share of the larger work. When it is destroyed the piece counts as done, unless
  /// an exception ended it.
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

  /// Returns a listener for a WorkProgress in another thread, on which this thread waits: it passes that
  /// thread's progress on to this one's listener.
  static Listener of_this_thread();

 private:
  // The piece of the whole that a thread works on, and how far the whole is.
  struct Work {
    Listener* listener = nullptr;
    double from = 0;
    double to = 1;
    double at = 0;
  };
  static thread_local Work work_;

  Listener listener_;
  // The work around, which is listened to again once this is over.
  Work outer_;
};

}  // namespace osteomill
