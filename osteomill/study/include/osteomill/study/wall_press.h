#pragma once

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/session/simulated_handle.h"

namespace osteomill {

/// A handle without a hand, pressed on a flat wall by a constant force of 0.5 N.
struct WallPress {
  /// Delay, encoder and mass.
  HandleSettings handle;
  /// Damping of the device itself.
  double damping_Ns_per_mm = 0.005;
  /// Haptic tick.
  double tick_s = 1e-3;
};

/// Behaviour of the handle's oscillation. `yields`: the wall is too soft to carry the force, so that no
/// oscillation is measured.
enum class WallMotion : unsigned char { decays, persists, yields };

/// Result of a press on a wall (press_on_wall()).
struct WallPressResult {
  WallMotion motion = WallMotion::yields;
  /// Slope of the force over the depth at the pressing force, when pressed slowly: the stiffness that a hand
  /// feels, N/mm. 0 if the wall gives way.
  double felt_N_per_mm = 0;
};

/// Presses the handle on bone that fills z < 0 (W). It moves only along z; the tool points up and its burr
/// touches at a height of `burr_radius_mm`. `algorithm` has been prepared for that wall.
///
/// First seeks, slowly, the depth at which the wall carries the force. Releases the handle there with a speed
/// that would make it swing by half of its penetration (at least 0.02, at most 0.1 mm: 4 to 20 encoder
/// steps), and measures up to 36 distances between successive turning points, for at most 2 s. The motion
/// dies out if two successive distances are below 0.015 mm (3 encoder steps: rounding sustains smaller ones),
/// or if the largest of the last third is below 0.99 of the largest of the middle third. Otherwise it goes
/// on; this is decided at once if a distance exceeds four times the first or the force is not finite. So both
/// growing and sustained oscillations go on.
///
/// Throws std::invalid_argument if a setting of the handle is out of range.
WallPressResult press_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press);

/// Runs only the first part: returns the stiffness that a hand feels at the pressing force, N/mm; 0 if the
/// wall gives way. Ignores the handle and damping of `press`.
double press_slowly_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press);

}  // namespace osteomill
