#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "osteomill/haptics/sample_points.h"

#include "verification/in_parallel.h"
#include "verification/probing.h"
#include "verification/pushes.h"
#include "verification/sections.h"

namespace osteomill::verification {

namespace {

constexpr int kPushesPerApproach = 40;
constexpr double kPast_mm = 5;
constexpr double kDeepest_mm = 0.3;
constexpr double kVoxel_mm = 0.25;

struct Approach {
  const char* name;
  /// Angle of the shaft from upright, degrees.
  double min_lean_deg;
  double max_lean_deg;
};
constexpr Approach kApproaches[] = {
    {"burr first", 0, 50}, {"shaft first", 80, 95}, {"shaft's end first", 130, 180}};

Volume sheet(double thick_mm) {
  GridGeometry geometry = testing_support::centred_cube(145, kVoxel_mm);
  geometry.dims[2] = 33;
  geometry.origin_mm.z() = -0.5 * 32 * kVoxel_mm + 0.1 * kVoxel_mm;
  return testing_support::shape_volume(
      geometry, [=](const Vec3& p) { return std::abs(p.z()) - 0.5 * thick_mm; }, 1);
}

double lowest_mm(const Pose& X_WT, const MillingTool& tool) {
  return std::min(X_WT.position_mm.z(), (X_WT * Vec3(0, 0, tool.shaft_length_mm)).z());
}

// Returns true if the simulated tool's centreline ends beyond the sheet that the device was pushed through.
bool goes_through(HapticAlgorithm& algorithm, const MillingTool& tool, const Approach& way, double thick_mm,
                  SeededRandom& random) {
  algorithm.reset();
  const double lean = random.uniform(way.min_lean_deg, way.max_lean_deg) / kDegrees;
  const double about = random.uniform(0, 2 * std::numbers::pi);
  const double speed_mm_s = 20 * std::pow(15, random.uniform(0, 1));
  Pose X_WD;
  X_WD.orientation = quaternion_from_rotation_vector(lean * Vec3(std::cos(about), std::sin(about), 0));
  // Starts with the middle of the tool slightly above the middle of the sheet.
  X_WD.position_mm = -(X_WD.orientation * Vec3(0, 0, 0.5 * tool.shaft_length_mm));
  X_WD.position_mm.z() = 0;
  X_WD.position_mm.z() = tool.burr_radius_mm + 1.5 - lowest_mm(X_WD, tool);
  const double way_mm = kPast_mm + tool.burr_radius_mm + 1.5;
  HapticStep step;
  for (double gone_mm = 0; gone_mm < way_mm; gone_mm += speed_mm_s * kTick_s) {
    X_WD.position_mm.z() -= speed_mm_s * kTick_s;
    step = algorithm.step(X_WD, kTick_s);
  }
  for (int n = 0; n < 50; ++n) step = algorithm.step(X_WD, kTick_s);
  return lowest_mm(step.X_WT, tool) < -0.5 * thick_mm - kDeepest_mm;
}

}  // namespace

Section thin_bone() {
  Section section{
      "Sheets of bone",
      fmt::format(
          "Must hold for 4: no push goes through. Sheets in {} mm voxels, edges one voxel wide; {} "
          "pushes each with the burr, with the shaft and with the shaft's end first. The device goes {} "
          "mm past the sheet at 20 to 300 mm/s without resistance. Through: the tool's centreline ends "
          "more than {} mm beyond the sheet.",
          kVoxel_mm, kPushesPerApproach, kPast_mm, kDeepest_mm),
      {"algorithm, sheet", "burr first", "shaft first", "shaft's end first", ""},
      {},
      {}};
  const MillingTool tool;
  for (const double thick_mm : {0.5, 0.25, 0.15}) {
    const Volume bone = sheet(thick_mm);
    for (const AlgorithmDescription& description : all_algorithms()) {
      const std::string& id = description.id.name;
      std::vector<int> through(std::size(kApproaches));
      in_parallel(through.size(), [&](std::size_t n) {
        const auto algorithm = make_algorithm(description, {});
        algorithm->prepare({&bone, tool});
        SeededRandom random(7 + n);
        for (int push = 0; push < kPushesPerApproach; ++push) {
          through[n] += goes_through(*algorithm, tool, kApproaches[n], thick_mm, random) ? 1 : 0;
        }
      });
      section.add_of(id,
                     {fmt::format("{}, {} mm", id, thick_mm), std::to_string(through[0]),
                      std::to_string(through[1]), std::to_string(through[2])},
                     std::all_of(through.begin(), through.end(), [](int n) { return n == 0; }));
    }
  }
  return section;
}

Section spongy_bone(const Bones& bones) {
  constexpr int kPushes = 300;
  Section section{
      "Pushes into spongy bone",
      fmt::format(
          "Must hold for 4: the tool is never more than {} mm past the surface. {} pushes of 2 to 10 N "
          "against {}, 0.0195 mm voxels, with a burr of 0.5 mm radius on a shaft of 0.35 mm.",
          kDeepest_mm, kPushes, bones.spongy_name),
      {"algorithm", "end deeper", "ever deeper", "deepest, mm", ""},
      {},
      {}};
  const BoneSurface surface(*bones.spongy);
  PushKind kind;
  kind.tool = {0.5, 0.35, 25};
  for (const std::string& id : algorithm_names()) {
    const std::vector<PushOutcome> all = push_outcomes(id, *bones.spongy, surface, kind, kPushes);
    const std::size_t ever = count_deeper(all, &PushOutcome::tool, &Depth::max_mm, kDeepest_mm);
    double deepest = -1;
    for (const PushOutcome& one : all) deepest = std::max(deepest, one.tool.max_mm);
    section.add_of(id,
                   {id, std::to_string(count_deeper(all, &PushOutcome::tool, &Depth::final_mm, kDeepest_mm)),
                    std::to_string(ever), figure(deepest)},
                   ever == 0);
  }
  return section;
}

}  // namespace osteomill::verification
