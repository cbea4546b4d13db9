#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// Completes a description with the fields of the algorithm's settings struct, whose defaults become the
/// settings' defaults, and with a function that creates `Algorithm`. Keeps a reference to `fields`, which
/// must outlive the description and all its copies (as fields_of does).
template <typename Algorithm, typename Settings>
AlgorithmDescription with_settings(AlgorithmDescription description,
                                   const std::vector<Field<Settings>>& fields) {
  for (const Field<Settings>& field : fields) description.settings.push_back({field, field.get(Settings{})});
  description.make = [&fields](std::span<const double> values) -> std::unique_ptr<HapticAlgorithm> {
    Settings settings;
    for (std::size_t n = 0; n < fields.size(); ++n) fields[n].set(settings, values[n]);
    return std::make_unique<Algorithm>(settings);
  };
  return description;
}

/// Describes the translational stiffness of a virtual coupling, for every algorithm that has one.
inline FieldDescription coupling_stiffness(const NumberRange& range) {
  return {.name = "translational-stiffness",
          .unit = "N/mm",
          .range = range,
          .doc = "Translational stiffness of the virtual coupling between the device and the simulated tool",
          .option = "stiffness"};
}

/// Describes the torsional stiffness of a virtual coupling.
inline FieldDescription coupling_torsion(const NumberRange& range) {
  return {.name = "torsional-stiffness",
          .unit = "N mm/rad",
          .range = range,
          .doc = "Torsional stiffness of the virtual coupling between the device and the simulated tool",
          .option = "torsional-stiffness"};
}

}  // namespace osteomill
