#include "osteomill/base/work_progress.h"

#include <algorithm>
#include <utility>

namespace osteomill {

thread_local WorkProgress::Work WorkProgress::work_;

WorkProgress::WorkProgress(Listener listener) : listener_(std::move(listener)), outer_(work_) {
  work_ = {&listener_};
}

WorkProgress::~WorkProgress() {
  work_ = outer_;
}

void WorkProgress::done(double share) {
  if (work_.listener == nullptr) return;
  work_.at = std::max(work_.at, work_.from + std::clamp(share, 0.0, 1.0) * (work_.to - work_.from));
  (*work_.listener)(work_.at);
}

WorkProgress::Part::Part(double until)
    : whole_from_(work_.from), whole_to_(work_.to), exceptions_(std::uncaught_exceptions()) {
  work_.from = std::max(work_.at, work_.from);
  work_.to = std::max(work_.from, whole_from_ + until * (whole_to_ - whole_from_));
}

WorkProgress::Part::~Part() {
  if (std::uncaught_exceptions() == exceptions_) work_.at = std::max(work_.at, work_.to);
  work_.from = whole_from_;
  work_.to = whole_to_;
}

WorkProgress::Listener WorkProgress::of_this_thread() {
  return [here = work_](double share) {
    if (here.listener == nullptr) return;
    (*here.listener)(std::max(here.at, here.from + share * (here.to - here.from)));
  };
}

}  // namespace osteomill
