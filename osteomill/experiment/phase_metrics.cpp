#include "osteomill/experiment/phase_metrics.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/trial_plan.h"

namespace osteomill {

namespace {

// How long the holding was to last; nothing of a recording that does not say so.
std::optional<double> held_for_s(const RunDescription& run) {
  for (const RunSetting& setting : run.settings) {
    if (setting.key != kScriptHoldingKey) continue;
    if (const double* seconds = std::get_if<double>(&setting.value)) return *seconds;
  }
  return std::nullopt;
}

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
  const std::optional<double> seconds = held_for_s(recording.description);
  if (recording.description.segment != kHolding || !seconds || !(*seconds > 0)) return run_metrics(recording);
  return run_metrics(last_of(recording, *seconds));
}

}  // namespace

RunMetrics phase_metrics(const Recording& recording) {
  RunMetrics metrics = metrics_of_time_held(recording);
  // The spindle is off while holding: what does not touch at all was lost before.
  metrics.contact.lost_while_milling |= recording.description.segment == kHolding && metrics.contact.any == 0;
  if (metrics.contact.is_lost()) {
    metrics.force_N = metrics.torque_Nmm = kNotFelt;
    metrics.shaft = {kNotMeasured, kNotMeasured};
    metrics.turns = {kNotMeasured, kNotMeasured};
    metrics.torque_follows_force = metrics.contacts_mean = kNotMeasured;
  }
  return metrics;
}

}  // namespace osteomill
