#include "osteomill/study/noticeable.h"

#include <cmath>

namespace osteomill {

namespace {

// Weber fractions, and the angle of a wrist (degrees); their sources are in the header.
constexpr double kForce = 0.07, kTorque = 0.13, kTremble = 0.20, kWrist_deg = 2;

}  // namespace

double least_noticeable(const FieldDescription& figure, double value) {
  const std::string& name = figure.name;
  if (name.find("_hp_") != std::string::npos) return kTremble * std::abs(value);
  if (name.starts_with("force_")) return kForce * std::abs(value);
  if (name.starts_with("torque_")) return kTorque * std::abs(value);
  if (name.starts_with("shaft_") && figure.unit == "degrees") return kWrist_deg;
  return 0;
}

std::string about_noticeable() {
  return "A difference counts as the same for a hand if it is less than a hand notices: 7 % of a force "
         "(Pang, Tan and Durlach 1991), 13 % of a torque (Jandura and Srinivasan 1994), 20 % of what "
         "trembles "
         "above 20 Hz (Forta, Griffin and Morioka 2012), 2 degrees of the shaft's direction (the wrist's, "
         "Tan et "
         "al. 1994; an eye on the tool sees less). They were measured with the attention on one thing; a "
         "hand "
         "that mills notices less.";
}

}  // namespace osteomill
