#pragma once

#include <vector>

#include "osteomill/session/milling_session.h"
#include "osteomill/session/simulated_operator.h"

namespace osteomill {

/// Everything that a trial depends on except for the bone and the entry. No person feels it, so only the
/// limits apply between the algorithm and the simulated hand (GuardSettings::for_simulation).
struct TrialSettings : MillingSetup {
  TrialSettings() : TrialSettings(MillingSetup{}) {}
  explicit TrialSettings(const MillingSetup& setup, const OperatorSettings& hand = {});

  OperatorSettings hand_and_device;
  /// Damping of the device itself, for a press on a wall without a hand.
  double device_damping_Ns_per_mm = 0.005;
  /// If false, the hand goes through its motions without removing bone, as section 8.1 measures rates.
  bool spindle = true;
};

/// Returns the CPU time of this thread, s. A system call, so not real-time safe.
double thread_cpu_s();

/// One algorithm in the test of section 8.2, in simulated time: a simulated hand mills a hole, leans the
/// shaft on its edge, and then holds still in it with the spindle off. The same settings give the same
/// records on any machine, except for the compute times.
class MillingTrial {
 public:
  /// One tick of the trial.
  struct Tick {
    TickRecord record;
    /// True in the first part of the test, false while the hand holds still.
    bool milling_phase;
  };

  /// Copies the bone. Throws std::invalid_argument if a setting is out of range.
  MillingTrial(const Volume& bone, const BoneDensities& densities, const MillingEntry& entry,
               const TrialSettings& settings);
  /// Continues from the state of `milled`, on copies of its bone and its hand, with the algorithm of `other`,
  /// whose hand, device and script are ignored. Throws std::invalid_argument if a setting is out of range.
  MillingTrial(const MillingTrial& milled, const TrialSettings& other);

  /// Returns whether the next tick belongs to milling rather than holding.
  bool is_milling() const { return operator_.is_spindle_requested(); }
  bool finished() const { return operator_.finished(); }
  /// Returns the parts of the script that the hand did not achieve.
  const ScriptShortfall& shortfall() const { return operator_.shortfall(); }
  /// Runs and returns the next tick, then advances the hand and the device. Does not allocate.
  Tick tick();

  /// Returns the bone as milled so far.
  const Volume& volume() const { return session_.volume(); }
  const HapticAlgorithm& algorithm() const { return session_.algorithm(); }

 private:
  // Records the time at which the tick ended: the time to advance the hand does not count.
  class TimedOperator final : public SimulatedOperator {
   public:
    using SimulatedOperator::SimulatedOperator;
    void tick_done(const Pose& X_WT, double dt_s) noexcept override {
      done_at_cpu_s = thread_cpu_s();
      SimulatedOperator::tick_done(X_WT, dt_s);
    }
    double done_at_cpu_s = 0;
  };

  MillingSession session_;
  TimedOperator operator_;
  double tick_s_;
  bool spindle_;
};

}  // namespace osteomill
