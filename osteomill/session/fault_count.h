#pragma once

#include <optional>
#include <string>

#include "osteomill/session/tick_record.h"

namespace osteomill {

/// Counts the ticks whose wrench could not be sent as it was. `add` is safe in the haptic tick.
class FaultCount {
 public:
  void add(const TickRecord& record);
  /// What to tell people, in one sentence; nothing where there were none. Not for the tick.
  std::optional<std::string> sentence() const;

 private:
  int clamped_ = 0;
  int not_finite_ = 0;
  int no_pose_ = 0;
  int jumped_or_late_ = 0;
};

}  // namespace osteomill
