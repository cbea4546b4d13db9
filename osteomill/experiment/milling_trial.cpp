#include "osteomill/experiment/milling_trial.h"

namespace osteomill {

MillingTrial::MillingTrial(const Volume& bone, const BoneDensities& densities, const MillingEntry& entry,
                           const AlgorithmDescription& algorithm, const TrialSettings& settings)
    : session_(bone, settings.tool, make_algorithm(algorithm, settings.haptics), densities, settings.milling,
               settings.limits),
      operator_(settings.hand_and_device, settings.tool, entry),
      tick_s_(settings.tick_s),
      spindle_(settings.spindle) {}

MillingTrial::Tick MillingTrial::tick() {
  const bool milling_phase = operator_.milling();
  const TickRecord record = session_.tick(operator_, operator_.time_s(), tick_s_, milling_phase && spindle_);
  operator_.see(record.X_WT);
  operator_.advance(tick_s_);
  return {record, milling_phase};
}

}  // namespace osteomill
