#include "osteomill/session/milling_setup.h"

#include <stdexcept>

#include <fmt/core.h>

#include "osteomill/milling/named_burrs.h"

namespace osteomill {

namespace {

// Fields without names; a recording stores them in its own attributes.
std::vector<Field<MillingTool>> tool_fields() {
  using T = MillingTool;
  constexpr unsigned kOwn = kToolField | kRecordedField;
  constexpr NumberRange kRadius{0.01, 100}, kLength{0.01, 1000};
  return {
      field<T>({"", "mm", kRadius, "Radius of the burr's sphere", kOwn, "burr-radius"}, &T::burr_radius_mm),
      field<T>({"", "mm", kRadius, "Radius of the shaft", kOwn, "shaft-radius"}, &T::shaft_radius_mm),
      field<T>({"", "mm", kLength, "Length of the shaft from the burr's centre", kOwn, "shaft-length"},
               &T::shaft_length_mm),
  };
}

}  // namespace

void require_workable(const MillingTool& tool, const GridGeometry& scan) {
  constexpr double kMaxVoxels = 150, kMinVoxels = 0.25;
  for (const Field<MillingTool>& size : tool_fields()) {
    if (size.range.contains(size.get(tool))) continue;
    throw std::invalid_argument(
        fmt::format("{} must be {} mm, not {:g}", size.option, range_text(size.range), size.get(tool)));
  }
  const Vec3 size_mm(scan.dims[0] * scan.spacing_mm.x(), scan.dims[1] * scan.spacing_mm.y(),
                     scan.dims[2] * scan.spacing_mm.z());
  const double widest_mm = size_mm.maxCoeff();
  const double voxel_mm = scan.spacing_mm.minCoeff();
  const auto require_narrower = [&](const char* what, double radius_mm) {
    if (2 * radius_mm <= widest_mm) return;
    throw std::invalid_argument(fmt::format(
        "the {}'s radius, {:g} mm, makes it {:g} mm wide, and the scan is {:.3g} x {:.3g} x {:.3g} mm", what,
        radius_mm, 2 * radius_mm, size_mm.x(), size_mm.y(), size_mm.z()));
  };
  require_narrower("burr", tool.burr_radius_mm);
  require_narrower("shaft", tool.shaft_radius_mm);
  const double radius_voxels = tool.burr_radius_mm / voxel_mm;
  if (radius_voxels > kMaxVoxels || radius_voxels < kMinVoxels) {
    throw std::invalid_argument(
        fmt::format("the burr's radius, {:g} mm, is {:.3g} of the scan's voxels ({:.3g} mm); {:g} to {:g} "
                    "can be felt",
                    tool.burr_radius_mm, radius_voxels, voxel_mm, kMinVoxels, kMaxVoxels));
  }
}

std::vector<std::string> setting_warnings(const MillingSetup& setup, const GridGeometry& scan) {
  require_workable(setup.tool, scan);
  return make_algorithm(setup.algorithm, setup.haptics)->setting_warnings(setup.tool, scan);
}

namespace {

ChipLaw chip_law_of(const MillingSetup& setup) {
  ChipLaw law = chip_law(setup.burr, setup.wear_cuts);
  if (setup.chip_energy_Nmm_per_mm3 > 0)
    law.edge = law.sharp = {setup.chip_energy_Nmm_per_mm3, law.sharp.chip_mm, setup.chip_exponent};
  law.edges = setup.chip_edges;
  return law;
}

}  // namespace

MillingSettings milling_settings(const MillingSetup& setup) {
  MillingSettings milling;
  milling.removal_rate_mm3_per_Ns = setup.removal_rate_mm3_per_Ns
                                        ? *setup.removal_rate_mm3_per_Ns
                                        : removal_rate_mm3_per_Ns(setup.cutting, setup.tool.burr_radius_mm);
  milling.spindle_speed_rpm = setup.cutting.spindle_speed_rpm;
  if (setup.law == CuttingLaw::chips) milling.chips = chip_law_of(setup);
  milling.tangential_share = milling.chips ? milling.chips->friction : setup.cutting.tangential_share;
  if (setup.cutting_reaction || setup.drag) milling.reaction_share = milling.tangential_share;
  return milling;
}

namespace {

using S = MillingSetup;

constexpr NumberRange kNotNegative = NumberRange::not_negative(), kSwitch = NumberRange::on_or_off(),
                      kLimit = NumberRange::limit();
// Within these ranges bone can resist the hand and the removed volume is finite.
constexpr NumberRange kSpeed{1, 1e6}, kEnergy{0.001, 1e6}, kRate{1e-12, 1e12}, kForce{0.1, 1000},
    kTorque{1, 1e5};

std::vector<Field<CuttingSettings>> cutting_fields() {
  using C = CuttingSettings;
  constexpr unsigned kOwn = kCuttingField | kRecordedField;
  return {
      field<C>(
          {"vibration.spindle_speed", "rpm", kSpeed, "Rotational speed of the burr", kOwn, "spindle-speed"},
          &C::spindle_speed_rpm),
      field<C>({"milling.cutting_energy", "N mm/mm^3", kEnergy,
                "Energy to remove bone of the reference density, per volume (--law constant-energy)",
                kOwn | kMayBeAbsent, "cutting-energy"},
               &C::specific_energy_Nmm_per_mm3),
  };
}

FieldDescription choice(const char* name, const char* doc, const char* option,
                        std::vector<std::string> choices) {
  const int last = static_cast<int>(choices.size()) - 1;
  return {name,
          "",
          NumberRange::count(0, last),
          doc,
          kCuttingField | kRecordedField | kMayBeAbsent,
          option,
          std::move(choices)};
}

template <typename Types>
std::vector<std::string> names_of(const Types& types) {
  std::vector<std::string> names;
  for (const auto& type : types) names.emplace_back(type.name);
  return names;
}

double usual_rpm(Handpiece handpiece) {
  return handpiece_types()[static_cast<std::size_t>(handpiece)].speed_rpm.value;
}

// Must come before the spindle speed, which takes precedence if both are set. Changes the speed only if it is
// the default of the previous handpiece.
Field<S> handpiece_field() {
  return {choice("spindle.handpiece",
                 "Handpiece, which slows down under load and sets the rotational speed unless "
                 "--spindle-speed is given; none holds the speed",
                 "handpiece", names_of(handpiece_types())),
          [](const S& s) { return static_cast<double>(s.handpiece); },
          [](S& s, double value) {
            const auto handpiece = static_cast<Handpiece>(value);
            double& speed_rpm = s.cutting.spindle_speed_rpm;
            if (speed_rpm == usual_rpm(s.handpiece)) speed_rpm = usual_rpm(handpiece);
            s.handpiece = handpiece;
          }};
}

// Burr by name. Must come before the tool's sizes and the kind of burr, which take precedence if set as well.
// Recordings store those, not the name.
Field<S> burr_name_field() {
  std::vector<std::string> names = names_of(named_burrs());
  names.insert(names.begin(), "own");
  const int last = static_cast<int>(names.size()) - 1;
  return {{"", "", NumberRange::count(0, last),
           "Named burr, which sets burr size, shaft and kind of burr: surgical, such as cutting-2 or "
           "diamond-2.5 (mm), or dental, such as dental-014 (ISO size); docs/exercises.md lists all",
           kToolField | kRecordedField, "burr-name", std::move(names)},
          [](const S& s) {
            const NamedBurr* burr = find_burr(s.tool, s.burr);
            return burr == nullptr ? 0.0 : static_cast<double>(burr - named_burrs().data() + 1);
          },
          [](S& s, double value) {
            if (value < 1) return;
            const NamedBurr& burr = named_burrs()[static_cast<std::size_t>(value) - 1];
            s.tool = burr.tool;
            s.burr = burr.edge;
          }};
}

Field<S> chip_field(const char* name, const char* unit, const NumberRange& range, const char* doc,
                    const char* option, double S::*member) {
  return field<S>({name, unit, range, doc, kCuttingField | kRecordedField | kMayBeAbsent, option}, member);
}

std::vector<Field<S>> law_fields() {
  return {
      handpiece_field(),
      field<S>(choice("milling.law",
                      "Cutting law: constant energy per volume of bone, or chips, which take more energy the "
                      "thinner they are",
                      "law", {"constant-energy", "chips"}),
               &S::law),
      field<S>(choice("milling.burr", "Kind of burr (--law chips)", "burr", names_of(burr_types())),
               &S::burr),
      chip_field(
          "milling.wear", "cuts", {0, 1000},
          "Number of cuts made before with the burr; every 20 lower its removal rate by 20 % (--law chips)",
          "wear", &S::wear_cuts),
      chip_field("milling.chip_energy", "N mm/mm^3", {0, 1e6},
                 "Energy to remove bone of the reference density in chips of 48 um, per volume, as fitted by "
                 "scripts/fit-cutting (--law chips); 0 takes the burr's own",
                 "chip-energy", &S::chip_energy_Nmm_per_mm3),
      chip_field("milling.chip_exponent", "", {0, 0.95},
                 "Exponent with which the energy of --chip-energy grows as chips get thinner",
                 "chip-exponent", &S::chip_exponent),
      chip_field("milling.chip_edges", "", {1, 100},
                 "Number of edges that cut per revolution: 1 for a burr with run-out, 2 for a twist drill "
                 "(--law chips)",
                 "chip-edges", &S::chip_edges),
  };
}

std::vector<Field<S>> removal_fields() {
  return {
      {{"milling.removal_rate", "mm^3/(N s)", kRate,
        "Volume of bone removed per time and force (default: computed from burr, spindle speed and cutting "
        "energy)",
        kCuttingField | kRecordedField | kDerivedField, "removal-rate"},
       [](const S& s) { return milling_settings(s).removal_rate_mm3_per_Ns; },
       [](S& s, double value) { s.removal_rate_mm3_per_Ns = value; }},
      field<S>({"", "", kSwitch, "Render the tangential cutting force of the burr; its pole then cuts less",
                kCuttingField, "cutting-reaction"},
               &S::cutting_reaction),
      field<S>({"milling.drag", "", kSwitch,
                "Render the friction of the spinning burr and shaft on bone that they do not cut",
                kCuttingField | kMayBeAbsent, "drag"},
               &S::drag),
      {{"milling.reaction_share", "", kNotNegative,
        "Rendered tangential force as a share of the burr's force; 0 if none is rendered"},
       [](const S& s) { return milling_settings(s).reaction_share; },
       [](S& s, double value) {
         s.cutting_reaction = value != 0;
         if (value != 0) s.cutting.tangential_share = value;
       }},
  };
}

std::vector<Field<GuardSettings>> guard_fields() {
  using G = GuardSettings;
  return {
      field<G>(
          {"limit.force", "N", kForce, "Limit of the force sent to the device", kLimitField, "force-limit"},
          [](auto& g) -> auto& { return g.limits.force_N; }),
      field<G>(
          {"limit.torque", "N mm", kTorque, "Limit of the torque sent to the device", kLimitField,
           "torque-limit"},
          [](auto& g) -> auto& { return g.limits.torque_Nmm; }),
      field<G>({"passivity_controller", "", kSwitch,
                "Passivity controller: damp a contact that has given the hand more energy than it took",
                kLimitField, "passivity-controller"},
               &G::passivity_controller),
      field<G>(
          {"guard.max_force_rate", "N/s", kLimit, "Limit of the rate of change of the force sent"},
          [](auto& g) -> auto& { return g.rates.force_N_s; }),
      field<G>(
          {"guard.max_torque_rate", "N mm/s", kLimit, "Limit of the rate of change of the torque sent"},
          [](auto& g) -> auto& { return g.rates.torque_Nmm_s; }),
      field<G>({"guard.blend", "s", kNotNegative, "Time over which a discontinuous wrench is blended in"},
               &G::blend_s),
      field<G>({"guard.max_move", "mm", kLimit,
                "Device translation in a tick beyond which the wrench falls to zero"},
               &G::max_move_mm),
      field<G>({"guard.max_turn", "rad", kLimit,
                "Device rotation in a tick beyond which the wrench falls to zero"},
               &G::max_turn_rad),
      field<G>({"guard.max_tick", "s", kLimit, "Length of a tick beyond which the wrench falls to zero"},
               &G::max_tick_s),
  };
}

std::vector<Field<VibrationSettings>> vibration_fields() {
  using V = VibrationSettings;
  return {
      field<V>(
          {"vibration", "", kSwitch, "Render the vibration of the cutting burr", kCuttingField, "vibration"},
          &V::on),
      field<V>({"vibration.force_share", "", kNotNegative,
                "Amplitude of the vibration as a share of the burr's force"},
               &V::force_share),
      field<V>({"vibration.max_force", "N", kNotNegative, "Limit of the vibration's force"}, &V::max_N),
  };
}

}  // namespace

namespace {

std::vector<Field<ContactTransientSettings>> transient_fields() {
  using C = ContactTransientSettings;
  return {
      field<C>({"contact_transient", "", kSwitch, "Render a knock when a fast tool meets bone",
                kCuttingField | kMayBeAbsent, "contact-transient"},
               &C::on),
      field<C>({"contact_transient.damping", "N s/mm", kNotNegative,
                "Amplitude of the knock per speed of the impact", kMayBeAbsent},
               &C::damping_N_s_per_mm),
      field<C>({"contact_transient.max_force", "N", kNotNegative, "Limit of the knock's force", kMayBeAbsent},
               &C::max_N),
  };
}

}  // namespace

template <>
const std::vector<Field<MillingSetup>>& fields_of<MillingSetup>() {
  static const std::vector<Field<S>> all =
      joined<S>({{burr_name_field()},
                 fields_within<S>(&S::tool, tool_fields()),
                 law_fields(),
                 fields_within<S>(&S::cutting, cutting_fields()),
                 removal_fields(),
                 fields_within<S>(&S::guard, guard_fields()),
                 fields_within<S>(&S::vibration, vibration_fields()),
                 fields_within<S>(&S::contact_transient, transient_fields())});
  return all;
}

}  // namespace osteomill
