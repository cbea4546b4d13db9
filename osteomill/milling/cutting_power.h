#pragma once

namespace osteomill {

/// What the removal rate kappa follows from. The defaults make a burr of 1.5 mm radius remove
/// 3.4 mm^3/(N s); they are plausible for bone, and no source is claimed for them.
struct CuttingSettings {
  double spindle_speed_rpm = 40000;
  /// The cutting (tangential) force at the burr's rim, as a share of the force with which it is pressed on.
  double tangential_share = 0.3;
  /// The work that removes a volume of bone of the reference density; N mm / mm^3 is MPa.
  double specific_energy_Nmm_per_mm3 = 550;
};

/// kappa in mm^3/(N s): the power of the cutting force at the rim's speed, per newton pressed, over the
/// specific energy. Throws std::invalid_argument where a setting or the radius is not a positive number.
double removal_rate_mm3_per_Ns(const CuttingSettings& cutting, double burr_radius_mm);

}  // namespace osteomill
