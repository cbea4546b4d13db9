#pragma once

#include <optional>
#include <string>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/spindle.h"
#include "osteomill/session/contact_transient.h"
#include "osteomill/session/wrench_guard.h"

namespace osteomill {

/// The vibration that a cutting burr gives the hand (in the paper; its force is in earlier work, so this one
/// is this project's own).
struct VibrationSettings {
  bool on = false;
  /// Its amplitude as a share of the force with which the burr presses, and the most it may be.
  double force_share = 0.08;
  double max_N = 0.3;
};

/// Everything that can be chosen for milling a bone, beside the bone.
struct MillingSetup {
  MillingTool tool;
  AlgorithmDescription algorithm = default_algorithm();
  HapticSettings haptics;
  CuttingSettings cutting;
  CuttingLaw law = CuttingLaw::constant_energy;
  /// For the law of chips: the kind of burr, and the cuts that it has made before.
  BurrEdge burr = BurrEdge::cutting;
  double wear_cuts = 0;
  /// A law of the user's own in the place of the kind's, unless the energy is 0: the work for 1 mm^3 of
  /// reference bone in chips of 48 um, and the exponent by which it grows in thinner ones. The edges that cut
  /// in a turn, whatever the burr.
  double chip_energy_Nmm_per_mm3 = 0;
  double chip_exponent = 0.3;
  double chip_edges = 1;
  /// The drive, whose free speed is `cutting.spindle_speed_rpm`.
  Handpiece handpiece = Handpiece::none;
  /// The rate with constant energy, if given; else it follows from `cutting` and the burr.
  std::optional<double> removal_rate_mm3_per_Ns;
  /// The hand feels how cutting holds the burr back along its speed (CuttingReaction).
  bool cutting_reaction = false;
  /// The hand also feels the burr and the shaft drag on bone if they cut nothing.
  bool drag = false;
  /// The hand feels the burr cut.
  VibrationSettings vibration;
  /// The hand feels a knock as it meets bone.
  ContactTransientSettings contact_transient;
  /// Protects a hand unless told otherwise (GuardSettings::for_simulation).
  GuardSettings guard;
  /// The nominal length of a tick.
  double tick_s = 1e-3;
};

/// A flag of the fields of a MillingSetup: a part of the tool.
inline constexpr unsigned kOfTheTool = 1;
/// A flag of the fields of a MillingSetup: a part of the cutting.
inline constexpr unsigned kOfTheCutting = 2;
/// A flag of the fields of a MillingSetup: one of the device's limits.
inline constexpr unsigned kOfTheLimits = 4;
/// A flag of the fields of a MillingSetup: a replay keeps the recording's value, because a recording is of
/// one scan, milled with one tool.
inline constexpr unsigned kOfTheRecording = 8;
/// A flag of the fields of a MillingSetup: unless set, the value follows from other fields.
inline constexpr unsigned kFollows = 16;

/// Returns every number of a setup except the tick and the algorithm's own settings, which its description
/// has.
template <>
const std::vector<Field<MillingSetup>>& fields_of<MillingSetup>();

/// Throws std::invalid_argument, with one line that says why, if a tool cannot work in a scan with this grid:
/// a size is out of its range, its burr or shaft is wider than the whole scan, or its burr is too many voxels
/// wide for any algorithm to follow at the haptic rate, or too few for the scan to give anything to feel.
/// Checked at once, before anything is prepared.
void require_workable(const MillingTool& tool, const GridGeometry& scan);

/// Returns a line for each setting of the algorithm that is poor for this tool in such a scan
/// (HapticAlgorithm::setting_warnings). Throws std::invalid_argument, with one line, as `require_workable`
/// does and if a setting is out of range or bone could not hold the tool with it: what a session would throw.
std::vector<std::string> setting_warnings(const MillingSetup& setup, const GridGeometry& scan);

/// Returns the settings by which a burr mills under this setup. Throws std::invalid_argument if one is out of
/// range.
MillingSettings milling_settings(const MillingSetup& setup);

}  // namespace osteomill
