#pragma once

#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// An algorithm felt where the right answer is known (probe()).
struct Probe {
  /// felt_stiffness_N_per_mm: with the burr on a flat wall.
  double felt_N_per_mm = 0;
  /// With the shaft across a sharp edge: how far the torque is from lever times force, as a share of it. Not
  /// a number if the shaft is not felt there.
  double torque_error = 0;
};

/// The key of the setting in which a recording has Probe::felt_N_per_mm; it is missing if it was not
/// measured.
inline constexpr const char* kFeltStiffnessKey = "probe.felt_stiffness";
/// The key of the setting in which a recording has Probe::torque_error; it is missing if it was not measured.
inline constexpr const char* kTorqueErrorKey = "probe.torque_error";

/// Probes the setup's algorithm with its settings on `wall` (flat_wall) and on `edge` (sharp_edge) of its
/// tool. Throws std::invalid_argument if a setting is out of range.
Probe probe(const MillingSetup& setup, const Volume& wall, const Volume& edge);

}  // namespace osteomill
