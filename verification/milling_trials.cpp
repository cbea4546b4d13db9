#include <cmath>

#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

// Settings were chosen on seeds 1 to 3.
constexpr std::uint64_t kFirstSeed = 11;

constexpr double kPushes_N[] = {1.5, 3};
// Upper limits for barrier-shell.
constexpr double kMaxHpOverMean = 0.02, kMaxTorqueStep_Nmm = 0.1, kMaxForceStep_N = 0.02;
constexpr double kMinForce_N = 0.8;
constexpr double kMinRemoved_mm3 = 30;
constexpr double kMinTorque_Nmm = 4;
constexpr double kPaidWithin = 0.01;

// Values of each figure over the seeds.
struct OverSeeds {
  std::vector<double> hp, torque_step, force_step, force, torque, removed, paid, step_us, milling_us;
};

OverSeeds over_seeds(const std::vector<TrialFigures>& figures) {
  OverSeeds all;
  for (const TrialFigures& f : figures) {
    all.hp.push_back(f.hp_over_mean());
    all.torque_step.push_back(f.metrics.torque_Nmm.step_max);
    all.force_step.push_back(f.metrics.force_N.step_max);
    all.force.push_back(f.metrics.force_N.mean);
    all.torque.push_back(f.metrics.torque_Nmm.mean);
    all.removed.push_back(f.metrics.removed_mm3);
    all.paid.push_back(f.paid_share);
    all.step_us.push_back(f.metrics.step_us.p99);
    all.milling_us.push_back(f.milling_us.p99);
  }
  return all;
}

bool holds(const OverSeeds& all, bool loaded) {
  const bool calm = percentile(all.hp, 1) <= kMaxHpOverMean &&
                    percentile(all.torque_step, 1) <= kMaxTorqueStep_Nmm &&
                    percentile(all.force_step, 1) <= kMaxForceStep_N;
  const bool paid = std::isnan(all.paid.front()) || (percentile(all.paid, 0) >= 1 - kPaidWithin &&
                                                     percentile(all.paid, 1) <= 1 + kPaidWithin);
  const bool works = percentile(all.force, 0) >= kMinForce_N &&
                     percentile(all.removed, 0) >= kMinRemoved_mm3 &&
                     percentile(all.torque, 0) >= kMinTorque_Nmm;
  return calm && paid && (!loaded || works);
}

std::string lowest_and_median(const std::vector<double>& values) {
  return fmt::format("{} ({})", figure(distribution_of(values).median), figure(percentile(values, 0)));
}

struct Rows {
  std::vector<std::string> algorithms = algorithm_names();
  bool random_hands = false;
  /// Also requires kMinForce_N, kMinTorque_Nmm and kMinRemoved_mm3.
  bool loaded = false;
  bool cutting_reaction = false;
  bool by_chips = false;
};

void add_rows(Section& section, const Volume& bone, const Effort& effort, const Rows& rows) {
  for (const double push_N : kPushes_N) {
    for (const std::string& algorithm : rows.algorithms) {
      std::vector<TrialVariant> variants;
      for (int n = 0; n < effort.seeds; ++n) {
        variants.push_back({.algorithm = algorithm,
                            .push_N = push_N,
                            .seed = kFirstSeed + static_cast<std::uint64_t>(n),
                            .phase_s = effort.phase_s,
                            .random_hand = rows.random_hands,
                            .cutting_reaction = rows.cutting_reaction,
                            .by_chips = rows.by_chips});
      }
      const OverSeeds all = over_seeds(milling_figures(bone, variants));
      section.add_of(
          algorithm,
          {fmt::format("{}, {} N{}{}", algorithm, push_N, rows.random_hands ? ", drawn hands" : "",
                       rows.by_chips ? ", chips, surgical drill, drag" : ""),
           median_and_worst(all.hp), median_and_worst(all.torque_step), median_and_worst(all.force_step),
           lowest_and_median(all.force), lowest_and_median(all.torque), lowest_and_median(all.removed),
           lowest_and_median(all.paid), median_and_worst(all.step_us), median_and_worst(all.milling_us)},
          holds(all, rows.loaded));
    }
  }
}

const std::vector<std::string> kHeader{"algorithm, push",
                                       "force above 20 Hz / mean",
                                       "torque step, N mm",
                                       "force step, N",
                                       "force mean, N (least)",
                                       "torque mean, N mm (least)",
                                       "removed, mm3 (least)",
                                       "removed / paid for (least)",
                                       "step p99, us",
                                       "milling p99, us",
                                       ""};

}  // namespace

Section milling_the_tooth(const Bones& bones, const Effort& effort) {
  Section section{
      "Milling the tooth",
      fmt::format(
          "Must hold for 4: force above 20 Hz over its mean, torque step and force step are at most {}, "
          "{} N mm and {} N; in the usual hand the mean force is at least {} N, at least {} mm3 are "
          "removed in 20 s, and the mean torque is at least {} N mm; the removed volume is what the "
          "burr's force paid for within 1 %. On {}, the simulated hand of `compare` for {:.0f} s, seeds "
          "{} to {} (settings were chosen on others); median (worst) over the seeds. Times were taken "
          "with another trial running in parallel.",
          kMaxHpOverMean, kMaxTorqueStep_Nmm, kMaxForceStep_N, kMinForce_N, kMinRemoved_mm3, kMinTorque_Nmm,
          bones.tooth_name, effort.phase_s, kFirstSeed,
          kFirstSeed + static_cast<std::uint64_t>(effort.seeds) - 1),
      kHeader,
      {},
      {}};
  add_rows(section, bones.tooth, effort, {.loaded = true});
  add_rows(section, bones.tooth, effort, {.random_hands = true});
  return section;
}

Section milling_with_cutting_reaction(const Bones& bones, const Effort& effort) {
  Section section{
      "Milling with the cutting reaction",
      fmt::format(
          "As above, on {} with `--cutting-reaction`: the hand feels the bone's resistance to the "
          "burr's rotation, which pushes the burr aside and turns the handle. Must hold for 4: it is as "
          "calm as without the reaction, and the removed volume is what the force paid for, which is "
          "less at the pole than at the equator.",
          bones.tooth_name),
      kHeader,
      {},
      {}};
  add_rows(section, bones.tooth, effort,
           {.algorithms = {default_algorithm().id.name}, .cutting_reaction = true});
  add_rows(section, bones.tooth, effort, {.algorithms = {default_algorithm().id.name}, .by_chips = true});
  return section;
}

Section half_rate_oscillation(const Bones& bones, const Effort& effort) {
  constexpr double kMostHalfRate_Nmm = 0.01, kMostStep_Nmm = 0.05;
  struct Encoder {
    const char* name;
    double mm, rad;
  };
  constexpr Encoder kUsual{"5 um, 0.1 mrad", 5e-3, 1e-4}, kFine{"1 um, 0.01 mrad", 1e-3, 1e-5};
  Section section{
      "No oscillation at half the haptic rate",
      fmt::format(
          "Must hold for 4: in no 0.1 s of leaning does the torque at half the haptic rate reach {} N "
          "mm (updating the bone's bricks in turns would make the tool sink at that rate); with the "
          "fine encoder no step of torque exceeds {} N mm. The hand of `compare` milling {} for {:.0f} "
          "s, seeds 11 to {}; median (worst).",
          kMostHalfRate_Nmm, kMostStep_Nmm, bones.tooth_name, effort.phase_s, 10 + effort.seeds),
      {"push, encoder", "torque at half the rate, N mm", "torque step, N mm", "force step, N", ""},
      {},
      {}};
  for (const double push_N : kPushes_N) {
    for (const Encoder& encoder : {kUsual, kFine}) {
      std::vector<TrialVariant> variants;
      for (int n = 0; n < effort.seeds; ++n) {
        variants.push_back({.push_N = push_N,
                            .seed = kFirstSeed + static_cast<std::uint64_t>(n),
                            .phase_s = effort.phase_s,
                            .encoder_mm = encoder.mm,
                            .encoder_rad = encoder.rad});
      }
      std::vector<double> half_rate, torque_step, force_step;
      for (const TrialFigures& f : milling_figures(bones.tooth, variants)) {
        half_rate.push_back(f.half_rate_Nmm);
        torque_step.push_back(f.metrics.torque_Nmm.step_max);
        force_step.push_back(f.metrics.force_N.step_max);
      }
      section.add({fmt::format("{} N, {}", push_N, encoder.name), median_and_worst(half_rate),
                   median_and_worst(torque_step), median_and_worst(force_step)},
                  percentile(half_rate, 1) < kMostHalfRate_Nmm &&
                      (encoder.mm == kUsual.mm || percentile(torque_step, 1) <= kMostStep_Nmm));
    }
  }
  return section;
}

Section milling_the_second_scan(const Bones& bones, const Effort& effort) {
  Section section{
      "Milling a scan not used for tuning",
      fmt::format("As above, on {}; load and removed volume depend on the bone and are only reported.",
                  bones.second_name),
      kHeader,
      {},
      {}};
  if (bones.second) add_rows(section, *bones.second, effort, {});
  return section;
}

}  // namespace osteomill::verification
