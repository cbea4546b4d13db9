#pragma once

#include <cstddef>
#include <exception>
#include <functional>

namespace osteomill {

/// Out of long work that is no longer wanted.
struct WorkStopped : std::exception {
  const char* what() const noexcept override { return "stopped, since it is no longer wanted"; }
};

/// Has the long work of this thread told of, as long as it lives: reading a scan, meshing it, preparing an
/// algorithm. Nothing is told of in the haptic tick. The work says how far it is wherever a tenth of a second
/// may have passed since it last did; one who no longer wants it throws WorkStopped from the listener, which
/// ends the work and gives its memory back.
class WorkProgress {
 public:
  /// Called often, in this thread, with the share done of the whole, from 0 to 1 and never falling.
  using Listener = std::function<void(double share_done)>;
  explicit WorkProgress(Listener listener);
  ~WorkProgress();
  WorkProgress(const WorkProgress&) = delete;
  WorkProgress& operator=(const WorkProgress&) = delete;

  /// The work says that it has done so much of itself. Nothing where nobody listens.
  static void done(double share);
  static void done(std::size_t parts, std::size_t of_parts) {
    done(of_parts > 0 ? static_cast<double>(parts) / static_cast<double>(of_parts) : 1);
  }

  /// What goes on while this lives is the next piece of a larger work: from where the one before ended to
  /// `until`, a share of the larger work. The end says that it is done, but not where the work was ended by
  /// an exception.
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

  /// Listens, to a WorkProgress in another thread, for the one that listens to this thread's work, which
  /// waits for that one's.
  static Listener of_this_thread();

 private:
  // What a thread works on: a piece of the whole, and how far the whole is.
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
