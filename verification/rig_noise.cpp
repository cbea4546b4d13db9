#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

// Largest ratio of force above 20 Hz over its mean with the spindle on to that with it off; two runs of one
// hand differ by as much.
constexpr double kMaxRatio = 1.05;

}  // namespace

Section rig_noise(const Bones& bones, const Effort& effort) {
  Section section{
      "Noise of the simulated rig",
      fmt::format("Must hold for 4: milling adds at most 5 % to the force above 20 Hz that the hand's tremor "
                  "causes with the spindle off. The hand of `compare` on {} for {:.0f} s, seed 11, with the "
                  "spindle on, with the spindle off, and with the spindle on but without rounding of the "
                  "handle's pose: one step of the encoder, 1e-4 rad, alone gives 0.1 N mm at 1000 N mm/rad.",
                  bones.tooth_name, effort.phase_s),
      {"algorithm, push", "force above 20 Hz / mean", "spindle off", "no rounding", "torque step, N mm",
       "spindle off", "no rounding", "force step, N", "spindle off", "no rounding", ""},
      {},
      {}};
  for (const double push_N : {1.5, 3.0}) {
    for (const std::string& algorithm : algorithm_names()) {
      const TrialVariant usual{
          .algorithm = algorithm, .push_N = push_N, .seed = 11, .phase_s = effort.phase_s};
      std::vector<TrialVariant> variants(3, usual);
      variants[1].spindle = false;
      variants[2].encoder_mm = variants[2].encoder_rad = 0;
      const std::vector<TrialFigures> f = milling_figures(bones.tooth, variants);
      std::vector<std::string> cells{fmt::format("{}, {} N", algorithm, push_N)};
      for (const TrialFigures& run : f) cells.push_back(figure(run.hp_over_mean()));
      for (const TrialFigures& run : f) cells.push_back(figure(run.metrics.torque_Nmm.step_max));
      for (const TrialFigures& run : f) cells.push_back(figure(run.metrics.force_N.step_max));
      section.add_of(algorithm, std::move(cells), f[0].hp_over_mean() <= kMaxRatio * f[1].hp_over_mean());
    }
  }
  return section;
}

}  // namespace osteomill::verification
