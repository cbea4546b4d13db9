#include "osteomill/haptics/line_proxy/shaft_balance.h"

#include <algorithm>

namespace osteomill::line_proxy {

double balanced_reaction_N(const ShaftContact& contact, const Vec3& line_tip_W, const Vec3& device_tip_W,
                           const std::optional<TipRest>& rest, const ShaftSprings& springs) {
  const double give_mm_per_N = 1.0 / springs.tip_N_per_mm;
  const double stiffness = springs.shaft_N_per_mm;
  // The depth there would be with the tool's tip at the device's.
  const double depth_mm = contact.depth_mm - contact.out_W.dot(device_tip_W - line_tip_W);
  const double free_N = std::max(0.0, stiffness * depth_mm / (1.0 + stiffness * give_mm_per_N));
  if (!rest) return free_N;
  const Vec3 tip_W = device_tip_W + free_N * give_mm_per_N * contact.out_W;
  if (!((rest->proxy_W - tip_W).dot(rest->normal_W) > 0.0)) return free_N;
  const double shared = contact.out_W.dot(rest->normal_W);
  const double raised_mm = (rest->proxy_W - device_tip_W).dot(rest->normal_W);
  const double resting_N = stiffness * (depth_mm - shared * raised_mm) /
                           (1.0 + stiffness * give_mm_per_N * (1.0 - shared * shared));
  return std::max(0.0, resting_N);
}

}  // namespace osteomill::line_proxy
