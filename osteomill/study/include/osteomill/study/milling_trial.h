#pragma once

#include <vector>

#include "osteomill/session/milling_session.h"
#include "osteomill/session/simulated_operator.h"

namespace osteomill {

/// All that a trial depends on but the bone and the entry. No person feels it, so that nothing but the limits
/// stands between the algorithm and the simulated hand (GuardSettings::for_simulation).
struct TrialSettings : MillingSetup {
  TrialSettings() : TrialSettings(MillingSetup{}) {}
  explicit TrialSettings(const MillingSetup& setup, const OperatorSettings& hand = {});

  OperatorSettings hand_and_device;
  /// The damping of the device itself, for a press on a wall without a hand.
  double device_damping_Ns_per_mm = 0.005;
  /// False lets the hand go through its motions without removing bone, as section 8.1 measures rates.
  bool spindle = true;
};

/// Returns the CPU time that this thread has taken so far, in s. A system call, so not for the tick.
double thread_cpu_s();

/// One algorithm in the test of section 8.2, in simulated time: a simulated hand mills a hole, leans the
/// shaft on its edge, and then stands in it with the spindle off. The same settings give the same records on
/// any machine, except for the compute times.
class MillingTrial {
 public:
  /// A tick of the trial.
  struct Tick {
    TickRecord record;
    /// True in the first part of the test, false while the hand holds still.
    bool milling_phase;
  };

  /// Copies the bone. Throws std::invalid_argument if a setting is out of range.
  MillingTrial(const Volume& bone, const BoneDensities& densities, const MillingEntry& entry,
               const TrialSettings& settings);
  /// Goes on where `milled` is, on a copy of its bone and in a copy of its hand, with the algorithm of
  /// `other`, whose hand, device and script do not count. Throws as the other constructor does.
  MillingTrial(const MillingTrial& milled, const TrialSettings& other);

  /// Returns whether the next tick is of the milling, and not of the holding.
  bool is_milling() const { return operator_.is_spindle_requested(); }
  bool finished() const { return operator_.finished(); }
  /// Returns what the hand could not bring about.
  const ScriptShortfall& shortfall() const { return operator_.shortfall(); }
  /// Runs and returns the next tick; then the hand and the device move on. No allocation.
  Tick tick();

  /// Returns the bone as milled so far.
  const Volume& volume() const { return session_.volume(); }
  const HapticAlgorithm& algorithm() const { return session_.algorithm(); }

 private:
  // The time that it takes to move on is not the tick's.
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
