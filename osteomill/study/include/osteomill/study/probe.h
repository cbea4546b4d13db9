#pragma once

#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Measurement of an algorithm on bones for which the correct result is known (probe()).
struct Probe {
  /// felt_stiffness_N_per_mm: with the burr on a flat wall.
  double felt_N_per_mm = 0;
  /// With the shaft across a sharp edge: deviation of the torque from lever arm times force, relative to it;
  /// NaN if the shaft is not felt there.
  double torque_error = 0;
};

/// Key of the setting with Probe::felt_N_per_mm in a recording; missing if not measured.
inline constexpr const char* kFeltStiffnessKey = "probe.felt_stiffness";
/// Key of the setting with Probe::torque_error in a recording; missing if not measured.
inline constexpr const char* kTorqueErrorKey = "probe.torque_error";

/// Probes the setup's algorithm with its settings on `wall` (flat_wall) and `edge` (sharp_edge), both made
/// for its tool. Throws std::invalid_argument if a setting is out of range.
Probe probe(const MillingSetup& setup, const Volume& wall, const Volume& edge);

}  // namespace osteomill
