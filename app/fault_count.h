#pragma once

#include <string_view>

#include "osteomill/session/tick_record.h"

namespace osteomill::app {

/// Counts the ticks whose wrench could not be sent as it was.
class FaultCount {
 public:
  void add(const TickRecord& record);
  /// One line on standard error, beginning with `who`, where there were any.
  void report(std::string_view who) const;

 private:
  int clamped_ = 0;
  int not_finite_ = 0;
};

}  // namespace osteomill::app
