#include "osteomill/numbers/work_progress.h"

#include <algorithm>
#include <utility>

namespace osteomill {

namespace {

// What this thread works on: a piece of the whole, and how far the whole is.
struct Work {
  WorkProgress::Listener* listener = nullptr;
  double from = 0;
  double to = 1;
  double at = 0;
};

thread_local Work work;

}  // namespace

WorkProgress::WorkProgress(Listener listener)
    : listener_(std::move(listener)),
      outer_listener_(work.listener),
      outer_from_(work.from),
      outer_to_(work.to),
      outer_at_(work.at) {
  work = {&listener_, 0, 1, 0};
}

WorkProgress::~WorkProgress() {
  work = {outer_listener_, outer_from_, outer_to_, outer_at_};
}

void WorkProgress::done(double share) {
  if (work.listener == nullptr) return;
  work.at = std::max(work.at, work.from + std::clamp(share, 0.0, 1.0) * (work.to - work.from));
  (*work.listener)(work.at);
}

WorkProgress::Part::Part(double until)
    : whole_from_(work.from), whole_to_(work.to), exceptions_(std::uncaught_exceptions()) {
  work.from = std::max(work.at, work.from);
  work.to = std::max(work.from, whole_from_ + until * (whole_to_ - whole_from_));
}

WorkProgress::Part::~Part() {
  if (std::uncaught_exceptions() == exceptions_) work.at = std::max(work.at, work.to);
  work.from = whole_from_;
  work.to = whole_to_;
}

WorkProgress::OfOtherThread::OfOtherThread()
    : listener_(work.listener), from_(work.from), to_(work.to), at_(work.at) {}

WorkProgress::OfOtherThread::Here::Here(const OfOtherThread& other) {
  work = {other.listener_, other.from_, other.to_, other.at_};
}

WorkProgress::OfOtherThread::Here::~Here() {
  work = {};
}

}  // namespace osteomill
