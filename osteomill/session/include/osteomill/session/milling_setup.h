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

/// Vibration that the hand feels while the burr cuts. The paper has one too, but specifies its force in
/// earlier work; this one is the project's own.
struct VibrationSettings {
  bool on = false;
  /// Amplitude as a fraction of the burr's force on the bone, and its maximum.
  double force_share = 0.08;
  double max_N = 0.3;
};

/// All settings for milling a bone, except for the bone itself.
struct MillingSetup {
  MillingTool tool;
  AlgorithmDescription algorithm = default_algorithm();
  HapticSettings haptics;
  CuttingSettings cutting;
  CuttingLaw law = CuttingLaw::constant_energy;
  /// For the chip law: the kind of burr, and the cuts that it has already made.
  BurrEdge burr = BurrEdge::cutting;
  double wear_cuts = 0;
  /// Replaces the chip law of the burr's kind unless the energy is 0: the work for 1 mm^3 of reference bone
  /// in 48 um chips, and the exponent of its growth for thinner ones. `chip_edges`, the cutting edges per
  /// turn, applies in any case.
  double chip_energy_Nmm_per_mm3 = 0;
  double chip_exponent = 0.3;
  double chip_edges = 1;
  /// The drive; its free speed is `cutting.spindle_speed_rpm`.
  Handpiece handpiece = Handpiece::none;
  /// Removal rate at constant energy; computed from `cutting` and the burr if not given.
  std::optional<double> removal_rate_mm3_per_Ns;
  /// Renders the tangential reaction of cutting (CuttingReaction).
  bool cutting_reaction = false;
  /// Renders the drag of the burr and the shaft on bone even if they cut nothing.
  bool drag = false;
  VibrationSettings vibration;
  ContactTransientSettings contact_transient;
  /// By default protects a human hand; see GuardSettings::for_simulation.
  GuardSettings guard;
  /// The nominal length of a tick.
  double tick_s = 1e-3;
};

/// Flag of a MillingSetup field: part of the tool.
inline constexpr unsigned kToolField = 1;
/// Flag of a MillingSetup field: part of the cutting.
inline constexpr unsigned kCuttingField = 2;
/// Flag of a MillingSetup field: one of the device's limits.
inline constexpr unsigned kLimitField = 4;
/// Flag of a MillingSetup field: a replay keeps the recorded value, because a recording belongs to one scan,
/// milled with one tool.
inline constexpr unsigned kRecordedField = 8;
/// Flag of a MillingSetup field: unless set, the value is computed from other fields.
inline constexpr unsigned kDerivedField = 16;

/// Returns the fields of a setup except for the tick length and the algorithm's own settings, which are in
/// its description.
template <>
const std::vector<Field<MillingSetup>>& fields_of<MillingSetup>();

/// Throws std::invalid_argument with a one-line reason if the tool cannot work in a scan with this grid: a
/// size is out of range, the burr or shaft is wider than the whole scan, or the burr spans too many voxels
/// for any algorithm at the haptic rate or too few to be felt. Fast; call before any preparation.
void require_workable(const MillingTool& tool, const GridGeometry& scan);

/// Returns one line for each setting of the algorithm that suits this tool and scan poorly
/// (HapticAlgorithm::setting_warnings). Throws std::invalid_argument as a session would: as
/// `require_workable` does, and if a setting is out of range or bone could not resist the tool with it.
std::vector<std::string> setting_warnings(const MillingSetup& setup, const GridGeometry& scan);

/// Returns the setup's settings for BurrMill. Throws std::invalid_argument if one is out of range.
MillingSettings milling_settings(const MillingSetup& setup);

}  // namespace osteomill
