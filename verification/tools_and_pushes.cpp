#include <algorithm>

#include <fmt/core.h>

#include "tests/shapes.h"
#include "verification/pushes.h"
#include "verification/sections.h"
#include "verification/trial_figures.h"

namespace osteomill::verification {

namespace {

constexpr double kPaidWithin = 0.01;
constexpr double kDeepest_mm = 0.3;
// Limits when breaking through: the smallest steps that one of our algorithms had reached, plus 5 %.
constexpr double kMaxForceStep_N = 0.052;
struct MaxTorqueStep {
  double push_N, step_Nmm;
};
constexpr MaxTorqueStep kMaxTorqueSteps[] = {{1.5, 0.29}, {3, 0.71}};

struct Case {
  MillingTool tool;
  double push_N;
};

}  // namespace

Section tools_and_pushes(const Bones& bones, const Effort& effort) {
  const int pushes = std::max(250, effort.pushes / 20);
  Section section{
      "Other tools and pushes",
      fmt::format(
          "Must hold for 4: the removed volume is what the burr's force paid for within {:g} %, and the "
          "tool is never more than {} mm past the surface; the rest is reported. Against {}, tools of "
          "0.5 to 3 mm with shafts thinner than the burr or as thick: {} pushes of 0.5 to 9 N at 20 to "
          "300 mm/s (end deeper / ever deeper), and the hand of `compare` milling for {:.0f} s, seed "
          "11. Settings were chosen for the default tool and hand.",
          100 * kPaidWithin, kDeepest_mm, bones.tooth_name, pushes, effort.phase_s),
      {"algorithm, burr / shaft, push", "deeper", "force above 20 Hz / mean", "torque step, N mm",
       "force step, N", "force mean, N", "torque mean, N mm", "removed, mm3", "removed / paid", ""},
      {},
      {}};
  const BoneSurface surface(bones.tooth);
  const Case cases[] = {{{0.5, 0.35, 25}, 1.5}, {{1, 1, 25}, 1.5}, {{2, 1, 25}, 1.5}, {{3, 3, 25}, 1.5},
                        {{1.5, 1, 25}, 0.5},    {{1.5, 1, 25}, 6}, {{1.5, 1, 25}, 9}};
  for (const std::string& id : algorithm_names()) {
    std::vector<TrialVariant> variants;
    for (const Case& one : cases) {
      variants.push_back(
          {.algorithm = id, .push_N = one.push_N, .seed = 11, .phase_s = effort.phase_s, .tool = one.tool});
    }
    const std::vector<TrialFigures> milled = milling_figures(bones.tooth, variants);
    for (std::size_t n = 0; n < std::size(cases); ++n) {
      PushKind kind;
      kind.tool = cases[n].tool;
      kind.min_N = 0.5;
      kind.max_N = 9;
      // The pushes do not depend on the milling hand's push, so they run once per tool.
      const bool is_first = n < 4;
      std::string felt = "-";
      std::size_t ever = 0;
      if (is_first) {
        const std::vector<PushOutcome> all = push_outcomes(id, bones.tooth, surface, kind, pushes);
        ever = count_deeper(all, &PushOutcome::tool, &Depth::max_mm, kDeepest_mm);
        felt = fmt::format("{} / {}", count_deeper(all, &PushOutcome::tool, &Depth::final_mm, kDeepest_mm),
                           ever);
      }
      const RunMetrics& m = milled[n].metrics;
      section.add_of(id,
                     {fmt::format("{}, {} / {} mm, {} N", id, kind.tool.burr_radius_mm,
                                  kind.tool.shaft_radius_mm, cases[n].push_N),
                      felt, figure(milled[n].hp_over_mean()), figure(m.torque_Nmm.step_max),
                      figure(m.force_N.step_max), figure(m.force_N.mean), figure(m.torque_Nmm.mean),
                      figure(m.removed_mm3), figure(milled[n].paid_share)},
                     std::abs(milled[n].paid_share - 1) <= kPaidWithin && ever == 0);
    }
  }
  return section;
}

Section breaking_through(const Effort& effort) {
  Section section{
      "Breaking through into a hollow",
      fmt::format(
          "Must hold for 4: the force steps by at most {} N, and the torque by {} N mm with a push of "
          "{} N, {} with {} N. A plate of 2.5 mm over a hollow, 0.125 mm voxels, is milled by the hand "
          "of `compare` for {:.0f} s, seed 11.",
          kMaxForceStep_N, kMaxTorqueSteps[0].step_Nmm, kMaxTorqueSteps[0].push_N,
          kMaxTorqueSteps[1].step_Nmm, kMaxTorqueSteps[1].push_N, effort.phase_s),
      {"algorithm, push", "force step, N", "torque step, N mm", "force mean, N", ""},
      {},
      {}};
  GridGeometry geometry = testing_support::centred_cube(112, 0.125);
  geometry.dims[2] = 72;
  const Volume bone = testing_support::shape_volume(geometry, [](const Vec3& p) {
    const double plate = std::abs(p.z() - 0.5) - 1.25;
    const double wall = std::max(5.0 - std::max(std::abs(p.x()), std::abs(p.y())), p.z() - 1.75);
    return std::max(std::min(plate, wall), std::max(std::abs(p.x()), std::abs(p.y())) - 6.3);
  });
  for (const auto& [push_N, most_Nmm] : kMaxTorqueSteps) {
    std::vector<TrialVariant> variants;
    for (const std::string& id : algorithm_names()) {
      variants.push_back({.algorithm = id, .push_N = push_N, .seed = 11, .phase_s = effort.phase_s});
    }
    const std::vector<TrialFigures> f = milling_figures(bone, variants);
    for (std::size_t n = 0; n < variants.size(); ++n) {
      const RunMetrics& m = f[n].metrics;
      section.add_of(variants[n].algorithm,
                     {fmt::format("{}, {} N", variants[n].algorithm, push_N), figure(m.force_N.step_max),
                      figure(m.torque_Nmm.step_max), figure(m.force_N.mean)},
                     m.force_N.step_max <= kMaxForceStep_N && m.torque_Nmm.step_max <= most_Nmm);
    }
  }
  return section;
}

}  // namespace osteomill::verification
