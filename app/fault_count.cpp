#include "app/fault_count.h"

#include <cstdio>

#include <fmt/core.h>

namespace osteomill::app {

void FaultCount::add(const TickRecord& record) {
  switch (record.fault) {
    case WrenchFault::none:
      return;
    case WrenchFault::force_clamped:
    case WrenchFault::torque_clamped:
    case WrenchFault::force_and_torque_clamped:
      ++clamped_;
      return;
    case WrenchFault::not_finite:
    case WrenchFault::pose_not_finite:
      ++not_finite_;
      return;
  }
}

void FaultCount::report(std::string_view who) const {
  if (clamped_ == 0 && not_finite_ == 0) return;
  fmt::print(
      stderr,
      "osteomill: {}: {} wrenches were clamped to the device's limits, {} were not finite and sent as zero\n",
      who, clamped_, not_finite_);
}

}  // namespace osteomill::app
