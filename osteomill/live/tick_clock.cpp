#include "osteomill/live/tick_clock.h"

#include <ctime>

namespace osteomill {

namespace {

constexpr Nanoseconds kNsPerS = 1'000'000'000;
constexpr Nanoseconds kSpin_ns = 100'000;

}  // namespace

Nanoseconds monotonic_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return kNsPerS * now.tv_sec + now.tv_nsec;
}

NextDeadline next_deadline(Nanoseconds deadline_ns, Nanoseconds now_ns, Nanoseconds period_ns) {
  const Nanoseconds passed = (now_ns - deadline_ns) / period_ns;
  const int periods = passed < 2 ? 1 : static_cast<int>(passed);
  return {deadline_ns + periods * period_ns, periods};
}

Nanoseconds wait_until(Nanoseconds deadline_ns) {
  const Nanoseconds wake_ns = deadline_ns - kSpin_ns;
  if (monotonic_now_ns() < wake_ns) {
    const timespec wake{wake_ns / kNsPerS, wake_ns % kNsPerS};
    // A signal ends the sleep early; what is left is slept on.
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) != 0) {
    }
  }
  Nanoseconds now_ns = monotonic_now_ns();
  while (now_ns < deadline_ns) now_ns = monotonic_now_ns();
  return now_ns;
}

}  // namespace osteomill
