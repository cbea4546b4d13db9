#include "osteomill/study/milling_trial.h"

#include <time.h>

namespace osteomill {

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TrialSettings::TrialSettings(const MillingSetup& setup, const OperatorSettings& hand)
    : MillingSetup(setup), hand_and_device(hand) {
  guard = GuardSettings::for_simulation(setup.guard.limits, setup.guard.passivity_controller);
}

MillingTrial::MillingTrial(const Volume& bone, const BoneDensities& densities, const MillingEntry& entry,
                           const TrialSettings& settings)
    : session_(std::make_shared<Volume>(bone), densities, settings),
      operator_(settings.hand_and_device, settings.tool, entry),
      tick_s_(settings.tick_s),
      spindle_(settings.spindle) {}

MillingTrial::MillingTrial(const MillingTrial& milled, const TrialSettings& other)
    : session_(std::make_shared<Volume>(milled.volume()), milled.session_.densities(), other),
      operator_(milled.operator_),
      tick_s_(milled.tick_s_),
      spindle_(milled.spindle_) {
  session_.resume_from(milled.session_.handover());
}

MillingTrial::Tick MillingTrial::tick() {
  const bool milling_phase = is_milling();
  const double before_s = thread_cpu_s();
  TickRecord record = session_.tick(
      operator_, {.time_s = operator_.time_s(), .dt_s = tick_s_, .spindle_on = milling_phase && spindle_});
  record.tick_cpu_us = 1e6 * (operator_.done_at_cpu_s - before_s);
  session_.shared_volume()->prefault_around(session_.last_change().voxels);
  return {record, milling_phase};
}

}  // namespace osteomill
