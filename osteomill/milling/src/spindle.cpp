#include "osteomill/milling/spindle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osteomill {

namespace {

constexpr const char* kMaker = "a maker's figures (W&H), abstract";
constexpr const char* kSlower = "speed halved at 9 N (Abouzgia and James 1995, JOMS 53:1308)";
constexpr const char* kRunUp = "assumed";
constexpr double kEndless = std::numeric_limits<double>::infinity();

constexpr HandpieceType kHandpieces[] = {
    {"none", {40000, "assumed: a surgical drill's"}, {kEndless, "assumed: holds any load"}, {0, kRunUp}},
    {"turbine",
     {400000, kMaker},
     {2.33, "the greatest of 41 air turbines (Brockhurst 1994, Aust Dent J 39:33)"},
     {0.15, kRunUp}},
    // 60 W at half the free speed, where a linear torque curve gives most power.
    {"electric", {200000, kMaker}, {11.5, kMaker}, {0.15, kRunUp}},
    // Torque for a burr of 1.5 mm radius that cuts at its equator, with a tangential share of 0.4.
    {"surgical",
     {40000, "assumed: within 20,000 to 100,000 (Abouzgia and James 1995)"},
     {8.1, kSlower},
     {0.15, kRunUp}},
};

}  // namespace

std::span<const HandpieceType> handpiece_types() {
  return kHandpieces;
}

void Spindle::step(bool is_on, double torque_Nmm, double dt_s) noexcept {
  // A coasting spindle slower than this fraction of the set speed counts as stopped.
  constexpr double kStanding = 1e-3;
  if (type_ == Handpiece::none) {
    speed_rpm_ = is_on ? set_rpm_ : 0;
    return;
  }
  if (!(dt_s > 0) || !std::isfinite(torque_Nmm)) return;
  const HandpieceType& type = kHandpieces[static_cast<std::size_t>(type_)];
  const double steps = dt_s / type.run_up_s.value;
  const double drive = (is_on ? 1 : 0) - torque_Nmm / type.stall_Nmm.value;
  const double share = (speed_rpm_ / set_rpm_ + steps * drive) / (1 + steps);
  speed_rpm_ = set_rpm_ * (share > (is_on ? 0 : kStanding) ? share : 0);
}

}  // namespace osteomill
