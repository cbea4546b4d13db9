#pragma once

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/session/simulated_handle.h"

namespace osteomill {

/// A handle alone, without a hand, that a constant force of 0.5 N presses on a flat wall.
struct WallPress {
  /// Its delay, encoder and mass.
  HandleSettings handle;
  /// The device's own damping.
  double damping_Ns_per_mm = 0.005;
  /// The haptic tick.
  double tick_s = 1e-3;
};

/// The fate of the handle's motion. `gives_way`: the wall is too soft to carry the force, so that there is no
/// motion to speak of.
enum class WallMotion : unsigned char { dies_out, goes_on, gives_way };

/// The result of a press on a wall (press_on_wall()).
struct WallPressResult {
  WallMotion motion = WallMotion::gives_way;
  /// The slope of the force over the depth about the pressing force, pressed slowly: the stiffness that a
  /// hand feels. 0 if the wall gives way.
  double felt_N_per_mm = 0;
};

/// Presses on bone that fills z < 0 (W) under the handle, whose only way is along z; the tool points up and
/// its burr touches at a height of `burr_radius_mm`. `algorithm` has been prepared for that wall.
///
/// First the depth is sought, slowly, at which the wall carries this force. There the handle is let go
/// with a speed that would swing it by half of what it is pressed in (at least 0.02, at most 0.1 mm: 4 to 20
/// steps of the encoder), and the distances from turning point to turning point are watched for 36 of them or
/// 2 s. The motion dies out if two of them running are under 0.015 mm (3 steps of the encoder: less than
/// that rounding keeps alive), or if the greatest of the last third is less than 0.99 of that of the
/// middle third; it goes on otherwise, at once if one exceeds four times the first or the force is not
/// finite. So what grows and what neither grows nor dies both go on.
///
/// Throws std::invalid_argument if a setting of the handle is out of range.
WallPressResult press_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press);

/// Returns the result of the first part alone: the stiffness that a hand feels about the pressing force, with
/// `press` except for its handle and damping; 0 if the wall gives way.
double press_slowly_on_wall(HapticAlgorithm& algorithm, double burr_radius_mm, const WallPress& press);

}  // namespace osteomill
