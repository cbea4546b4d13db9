#pragma once

#include <limits>

#include "osteomill/haptics/algorithm_id.h"
#include "osteomill/haptics/line_proxy/surface_normal.h"

namespace osteomill {

/// Which point of the shaft draws the intersection point to itself.
enum class ShaftProbeRule : unsigned char {
  /// The paper's v_max. It leaps from vertex to vertex and from one grain of the scan to the next.
  densest,
  /// The middle of the shaft's way through the bone. On an edge the lever is off by up to half that way, and
  /// the force is about half.
  middle,
  /// The place that must be moved furthest across the shaft to come free, found from the middle: at an edge,
  /// the edge.
  deepest_across,
};

/// What algorithm 1 is made of. The first block is the paper's; every field of the second is an improvement
/// that can be switched by itself, and whose initial value is the paper's behaviour. Limits are per tick,
/// meant for 1 kHz.
struct LineProxySettings {
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  /// Vertices on the centreline, the burr's centre included; at least 2.
  int vertices = 51;
  /// The spring of eq. 6 and 10.
  double stiffness_N_per_mm = 2.0;
  /// NUMBER_OF_TRANSLATION_STEPS and NUMBER_OF_ROTATION_STEPS of eq. 3 and 4; at least 1 each.
  int translation_steps = 10;
  int rotation_steps = 10;
  /// How the isosurface's normal is found; the paper does not say.
  line_proxy::NormalRule normal;

  /// Keeps the fraction of eq. 1 between 0 and 1, so that the intersection point lies on the vertex's path.
  bool clamp_fraction = false;
  /// An intersection point further than this from the colliding vertex, or from the one before it, is
  /// refused.
  double intersection_jump_limit_mm = kNoLimit;
  /// Refuses an intersection point on the other side of the tip than the shaft.
  bool refuse_behind_tip = false;
  /// How far the intersection point may slide over the bone in a tick.
  double intersection_slide_limit_mm = kNoLimit;
  /// How far the tip's proxy may move in a tick beyond the device's own movement, so that the force fades
  /// instead of stepping where the proxy comes free.
  double tip_proxy_limit_mm = kNoLimit;
  /// The tip stays in contact until its proxy has a free way to it: no falling through thin walls.
  bool contact_until_proxy_is_free = false;
  /// Which point of the shaft draws the intersection point to itself.
  ShaftProbeRule shaft_probe = ShaftProbeRule::densest;
  /// Sends the shaft's reaction force as well as its torque.
  bool shaft_pushes = false;
  /// The reaction of the shaft grows from nothing at the tip to full at this many shaft radii from it; 0 for
  /// none.
  double shaft_fade_radii = 0.0;
  /// How much the reaction of the shaft may change in a tick.
  double shaft_force_slew_N = kNoLimit;
  /// How fast the simulated tool goes over between touching and free, in a tick, beyond the device's own
  /// movement.
  double tool_glide_mm = kNoLimit;
  double tool_glide_rad = kNoLimit;

  /// `paper` as printed, or `steady` with every improvement at the value that was found best.
  static LineProxySettings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const LineProxySettings& settings);

}  // namespace osteomill
