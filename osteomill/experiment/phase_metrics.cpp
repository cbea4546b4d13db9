#include "osteomill/experiment/phase_metrics.h"

#include <algorithm>
#include <cmath>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/trial_plan.h"

namespace osteomill {

namespace {

Recording last_of(const Recording& recording, double seconds) {
  const auto ticks =
      static_cast<std::size_t>(std::max(0.0, std::round(seconds / recording.description.tick_period_s)));
  const auto& records = recording.records;
  Recording last;
  last.path = recording.path;
  last.description = recording.description;
  last.records.assign(records.end() - static_cast<std::ptrdiff_t>(std::min(ticks, records.size())),
                      records.end());
  return last;
}

RunMetrics metrics_of_time_held(const Recording& recording) {
  const double* seconds = find_setting<double>(recording.description, kScriptHoldingKey);
  if (recording.description.phase != kHolding || seconds == nullptr || !(*seconds > 0))
    return run_metrics(recording);
  const Recording counted = last_of(recording, *seconds);
  RunMetrics metrics = run_metrics(counted);
  metrics.counted_from_s = counted.records.front().time_s - recording.records.front().time_s;
  return metrics;
}

}  // namespace

RunMetrics phase_metrics(const Recording& recording) {
  RunMetrics metrics = metrics_of_time_held(recording);
  // The spindle is off while holding: what does not touch at all was lost before.
  metrics.contact.lost_while_milling |= recording.description.phase == kHolding && metrics.contact.any == 0;
  if (metrics.contact.is_lost()) {
    metrics.force_N = metrics.torque_Nmm = kNotFelt;
    metrics.shaft = {kNotMeasured, kNotMeasured};
    metrics.turns = {kNotMeasured, kNotMeasured};
    metrics.torque_follows_force = metrics.contacts_mean = kNotMeasured;
  }
  return metrics;
}

}  // namespace osteomill
