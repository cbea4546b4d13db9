#pragma once

#include <limits>

#include "osteomill/haptics/algorithm_id.h"
#include "osteomill/haptics/line_proxy/surface_normal.h"

namespace osteomill {

/// What algorithm 1 is made of. The first block is the paper's; every field of the second is an improvement
/// that can be switched by itself, and whose initial value is the paper's behaviour. Limits are per second,
/// so that the haptic rate does not matter.
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
  /// How fast the tip's proxy may move beyond the device's own movement, so that the force fades instead of
  /// stepping where the proxy comes free.
  double tip_proxy_limit_mm_per_s = kNoLimit;
  /// The tip stays in contact until its proxy has a free way to it: no falling through thin walls.
  bool contact_until_proxy_is_free = false;
  /// The shaft's reaction comes from where and which way the line must be moved to come free, instead of from
  /// the densest point, and pushes the tool's tip away, so that it is felt as a force as well as a torque.
  bool shaft_contact = false;
  /// The spring that holds the tool's orientation to the device's where such a contact turns it, in the place
  /// of eq. 10; above 0. Below 1 kHz it is softer in proportion.
  double shaft_turning_Nmm_per_rad = 3000.0;
  /// The reaction of the shaft grows from nothing at the tip to full at this many shaft radii from it; 0 for
  /// none. (With `shaft_contact` by the square of the lever, and where the shaft alone holds the tool.)
  double shaft_fade_radii = 0.0;
  /// How much of the way to where the shaft's contact points its push turns in a tick, in (0, 1].
  double contact_turning_share = 1.0;
  /// How fast the shaft's contact may slide along it, ...
  double contact_slide_limit_mm_per_s = kNoLimit;
  /// ... and change its reaction beyond what the device's own movement calls for.
  double shaft_force_slew_N_per_s = kNoLimit;
  /// Keeps the simulated tool, as wide as it is, out of bone that its centreline does not touch yet.
  bool show_outside = false;
  /// How fast the simulated tool goes over between touching and free, beyond the device's own movement.
  double tool_glide_mm_per_s = kNoLimit;
  double tool_glide_rad_per_s = kNoLimit;

  /// `paper` as printed, or `steady` with every improvement at the value that was found best.
  static LineProxySettings defaults(Mode mode);
};

/// Throws std::invalid_argument, naming the setting, where one is out of range.
void require_valid(const LineProxySettings& settings);

}  // namespace osteomill
