#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/barrier_shell_counts.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/milling_setup.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr const char* kOurs = "barrier-shell";

// Bone below z = 0 in a cube of 16 mm.
const Volume& small_bone() {
  static const Volume bone = testing_support::shape_volume(
      testing_support::centred_cube(64, 0.25), testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  return bone;
}

// Part of the tool placed on the bone, and the resulting height of the tool's origin.
struct Placement {
  const char* name;
  Quat orientation;
  double (*height_mm)(const MillingTool&);
};
const Placement kPlacements[] = {
    {"burr", Quat::Identity(), [](const MillingTool& tool) { return tool.burr_radius_mm; }},
    {"end", Quat::FromTwoVectors(Vec3::UnitZ(), -Vec3::UnitZ()),
     [](const MillingTool& tool) { return std::max(tool.shaft_length_mm, tool.burr_radius_mm); }},
    {"side", Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX()),
     [](const MillingTool& tool) { return std::max(tool.burr_radius_mm, tool.shaft_radius_mm); }},
};

struct Pressed {
  double wanted_N;
  double force_N = 0;
  // Penetration depth of the shown tool.
  double sunk_mm = 0;
  bool finite = true;
  // Maximum number of points read or summed in a tick.
  std::uint64_t max_points = 0;
};

// Moves the hand down, half a percent deeper each tick, until it feels the target force or reaches its limit.
Pressed press(const MillingSetup& setup, const Placement& placement, bool spindle_on) {
  constexpr double kWanted_N = 3, kArm_mm = 100, kAbove_mm = 0.5, kTick_s = 1e-3;
  constexpr int kHeldTicks = 200;
  MillingSession session(std::make_shared<Volume>(small_bone()), {0, 1000}, setup);
  PosedDevice device;
  Pressed pressed{.wanted_N = std::min(kWanted_N, 0.9 * setup.guard.limits.force_N)};
  const double touching_mm = placement.height_mm(setup.tool);
  double time_s = 0;
  const auto tick_at = [&](double depth_mm) {
    device.put({{0.06, 0.03, touching_mm - depth_mm}, placement.orientation});
    const TickRecord tick =
        session.tick(device, {.time_s = time_s += kTick_s, .dt_s = kTick_s, .spindle_on = spindle_on});
    pressed.finite = pressed.finite && is_finite(tick.X_WT) && tick.fault != WrenchFault::not_finite;
    pressed.force_N = tick.wrench.force_N.z();
    pressed.sunk_mm = std::max(pressed.sunk_mm, touching_mm - tick.X_WT.position_mm.z());
  };
  for (double above_mm = kAbove_mm; above_mm > 0; above_mm -= 0.01) tick_at(-above_mm);
  double depth_mm = 0.001;
  while (pressed.force_N < pressed.wanted_N && depth_mm < kArm_mm) tick_at(depth_mm *= 1.005);
  for (int n = 0; n < kHeldTicks; ++n) tick_at(depth_mm);
  const auto* counts = barrier_shell::counts_of(session.algorithm());
  pressed.max_points = counts != nullptr
                           ? counts->max_points
                           : static_cast<std::uint64_t>(session.algorithm().sample_point_count());
  return pressed;
}

bool says(const std::string& line, const std::string& word) {
  return line.find(word) != std::string::npos && line.find_first_of("0123456789") != std::string::npos;
}

// Expects bone to hold a tool pressed with a few newtons, or the setup to be refused or to give a warning
// that names `setting`. For our own algorithm a warning is not enough.
void expect_held_or_warned(const MillingSetup& setup, const std::string& setting) {
  // Takes a few hundred microseconds.
  constexpr std::uint64_t kMaxPoints = 20000;
  constexpr double kMaxDepth_mm = 0.3;
  const bool is_ours = setup.algorithm.id == kOurs;
  std::vector<std::string> warnings;
  try {
    warnings = setting_warnings(setup, small_bone().geometry());
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(says(error.what(), setting)) << error.what();
    EXPECT_THROW(press(setup, kPlacements[0], false), std::invalid_argument)
        << "the session has to refuse it too";
    return;
  }
  for (const std::string& warning : warnings) EXPECT_TRUE(says(warning, setting)) << warning;
  // With the paper's algorithms the shaft alone gives only a torque.
  for (const Placement& placement : is_ours ? std::span(kPlacements) : std::span(kPlacements).first(1)) {
    const Pressed pressed = press(setup, placement, false);
    EXPECT_TRUE(pressed.finite) << placement.name;
    if (!warnings.empty() && !is_ours) continue;
    EXPECT_GT(pressed.force_N, 0.9 * pressed.wanted_N) << placement.name;
    EXPECT_LE(pressed.max_points, kMaxPoints) << placement.name;
    EXPECT_LT(pressed.sunk_mm, is_ours ? kMaxDepth_mm : setup.tool.burr_radius_mm) << placement.name;
  }
}

MillingSetup setup_of(const AlgorithmDescription& algorithm) {
  return {.algorithm = algorithm, .guard = GuardSettings::for_simulation()};
}

TEST(SettingRanges, DefaultsHoldTheToolWithoutWarnings) {
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    SCOPED_TRACE(algorithm.id.name);
    EXPECT_TRUE(setting_warnings(setup_of(algorithm), small_bone().geometry()).empty());
    expect_held_or_warned(setup_of(algorithm), "none");
  }
}

TEST(SettingRanges, AlgorithmSettingsAtTheirLimitsHoldTheToolOrWarn) {
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    for (const SettingDescription& setting : algorithm.settings) {
      for (const double value : {setting.range.min, setting.range.max}) {
        SCOPED_TRACE(algorithm.id.name + "." + setting.name + " = " + std::to_string(value));
        MillingSetup setup = setup_of(algorithm);
        setup.haptics.named = {{algorithm.id.name, setting.name, value}};
        expect_held_or_warned(setup, setting.name);
      }
    }
  }
}

TEST(SettingRanges, SetupFieldsAtTheirLimitsHoldTheToolOrWarn) {
  for (const Field<MillingSetup>& field : fields_of<MillingSetup>()) {
    if (field.option.empty()) continue;
    for (const AlgorithmDescription& algorithm : all_algorithms()) {
      for (const double value : {field.range.min, field.range.max}) {
        SCOPED_TRACE(algorithm.id.name + ", " + field.option + " = " + std::to_string(value));
        MillingSetup setup = setup_of(algorithm);
        field.set(setup, value);
        expect_held_or_warned(setup, field.option.substr(0, field.option.find('-')));
      }
    }
  }
}

// Bone is removed under the burr, so this checks only the sent wrench.
TEST(SettingRanges, CuttingSettingsAtTheirLimitsGiveFiniteWrenches) {
  for (const Field<MillingSetup>& field : fields_of<MillingSetup>()) {
    if (!field.has(kCuttingField) || field.option.empty()) continue;
    for (const double value : {field.range.min, field.range.max}) {
      SCOPED_TRACE(field.option + " = " + std::to_string(value));
      MillingSetup setup = setup_of(default_algorithm());
      setup.cutting_reaction = setup.vibration.on = true;
      field.set(setup, value);
      EXPECT_TRUE(press(setup, kPlacements[0], true).finite);
    }
  }
}

TEST(SettingRanges, DefaultAlgorithmHoldsThinShortAndThickTools) {
  for (const MillingTool& tool :
       {MillingTool{0.2, 0.1, 25}, MillingTool{0.1, 1, 25}, MillingTool{1.5, 0.1, 25},
        MillingTool{1.5, 1, 0.3}, MillingTool{5, 3, 25}}) {
    SCOPED_TRACE(std::to_string(tool.burr_radius_mm) + " " + std::to_string(tool.shaft_radius_mm));
    MillingSetup setup = setup_of(default_algorithm());
    setup.tool = tool;
    expect_held_or_warned(setup, "none");
  }
}

}  // namespace
}  // namespace osteomill
