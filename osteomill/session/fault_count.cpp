#include "osteomill/session/fault_count.h"

#include <fmt/core.h>

namespace osteomill {

void FaultCount::add(const TickRecord& record) {
  switch (record.fault) {
    case WrenchFault::none:
    case WrenchFault::eased:
      return;
    case WrenchFault::force_clamped:
    case WrenchFault::torque_clamped:
    case WrenchFault::force_and_torque_clamped:
      ++clamped_;
      return;
    case WrenchFault::not_finite:
      ++not_finite_;
      return;
    case WrenchFault::pose_not_finite:
      ++no_pose_;
      return;
    case WrenchFault::pose_jumped:
    case WrenchFault::tick_late:
      ++jumped_or_late_;
      return;
  }
}

std::optional<std::string> FaultCount::sentence() const {
  if (clamped_ == 0 && not_finite_ == 0 && no_pose_ == 0 && jumped_or_late_ == 0) return std::nullopt;
  return fmt::format(
      "{} wrenches were clamped to the device's limits, {} were not finite and sent as zero, {} were sent as "
      "zero since the device gave no pose (a clutch that was held among them), {} since it jumped or the "
      "tick "
      "came late",
      clamped_, not_finite_, no_pose_, jumped_or_late_);
}

}  // namespace osteomill
