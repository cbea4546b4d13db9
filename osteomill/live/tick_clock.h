#pragma once

#include <cstdint>

namespace osteomill {

/// Nanoseconds of the system's monotonic clock.
using Nanoseconds = std::int64_t;

Nanoseconds monotonic_now_ns();

/// The deadline after one that was met, or not: `periods` after it.
struct NextDeadline {
  Nanoseconds deadline_ns;
  int periods;
};

/// The next deadline of a loop of `period_ns`, at `now_ns` when the tick of `deadline_ns` is done: one period
/// on, or, where that lies a whole period or more in the past, the last one that has passed. Ticks that were
/// missed are not made up for: they would come in a burst, faster than any device takes them.
NextDeadline next_deadline(Nanoseconds deadline_ns, Nanoseconds now_ns, Nanoseconds period_ns);

/// Sleeps until 100 us before the deadline (clock_nanosleep to an absolute time), then looks at the clock
/// until it has come: waking from sleep is what is late. Returns the time at which it returns.
Nanoseconds wait_until(Nanoseconds deadline_ns);

}  // namespace osteomill
