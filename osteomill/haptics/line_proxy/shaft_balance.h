#pragma once

#include <optional>

#include "osteomill/haptics/line_proxy/shaft_contact.h"

namespace osteomill::line_proxy {

/// Where the tip's proxy rests on bone.
struct TipRest {
  Vec3 proxy_W;
  /// Unit, out of the bone.
  Vec3 normal_W;
};

/// The springs that balance where the shaft touches.
struct ShaftSprings {
  /// From the device's tip to the tool's: eq. 6. N/mm.
  double tip_N_per_mm;
  /// What the reaction grows with where the tip cannot give way: eq. 10. N/mm.
  double shaft_N_per_mm;
};

/// The reaction of the shaft along its contact's way out (N, 0 or more) at which the tool is in balance: the
/// contact pushes the tool's tip away from the device's against the spring of eq. 6, across the surface the
/// tip rests on not at all, and what then is left of its depth is the reaction over the spring of eq. 10.
/// `contact` was found with the line's tip at `line_tip_W`. Safe in the haptic tick.
double balanced_reaction_N(const ShaftContact& contact, const Vec3& line_tip_W, const Vec3& device_tip_W,
                           const std::optional<TipRest>& rest, const ShaftSprings& springs);

}  // namespace osteomill::line_proxy
