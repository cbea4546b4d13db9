#include "osteomill/recording/repeat_milling.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_reaction.h"

namespace osteomill {

namespace {

[[noreturn]] void refuse(const Recording& recording, const std::string& reason) {
  throw InputError(recording.path.string(), reason);
}

std::string grid_text(const std::array<int, 3>& dims, const Vec3& spacing_mm) {
  return fmt::format("{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm", dims[0], dims[1], dims[2],
                     spacing_mm.x(), spacing_mm.y(), spacing_mm.z());
}

void require_same_grid(const Recording& recording, const GridGeometry& geometry) {
  const RunDescription& run = recording.description;
  if (run.dims == geometry.dims && run.spacing_mm.isApprox(geometry.spacing_mm, 1e-9)) return;
  refuse(recording,
         fmt::format("was made with another scan ({}): {}, not {}", run.scan_name,
                     grid_text(run.dims, run.spacing_mm), grid_text(geometry.dims, geometry.spacing_mm)));
}

const double* find_number(const Recording& recording, const char* key) {
  const std::vector<RunSetting>& settings = recording.description.settings;
  const auto found = std::find_if(settings.begin(), settings.end(),
                                  [&](const RunSetting& setting) { return setting.key == key; });
  return found == settings.end() ? nullptr : std::get_if<double>(&found->value);
}

double number_of(const Recording& recording, const char* key) {
  const double* number = find_number(recording, key);
  if (number == nullptr) {
    refuse(recording, fmt::format("has no setting '{}', so its milling cannot be repeated", key));
  }
  return *number;
}

MillingSettings milling_of(const Recording& recording) {
  // Recordings from before the burr was held back do not have it.
  const double* reaction_share = find_number(recording, "milling.reaction_share");
  return {number_of(recording, "milling.removal_rate"), reaction_share == nullptr ? 0 : *reaction_share};
}

BurrMill make_mill(const Recording& recording, const MillingSettings& milling, const GridGeometry& geometry) {
  const BoneDensities densities{number_of(recording, "milling.surroundings_density"),
                                number_of(recording, "milling.reference_density")};
  try {
    return BurrMill(geometry, recording.description.tool.burr_radius_mm, densities, milling);
  } catch (const std::invalid_argument& error) {
    refuse(recording, fmt::format("cannot be repeated: {}", error.what()));
  }
}

void require_same_removal(const Recording& recording, std::size_t tick, double removed_mm3) {
  const double recorded_mm3 = recording.records[tick].removed_mm3;
  if (removed_mm3 == recorded_mm3) return;
  if (tick == 0) {
    refuse(recording, fmt::format("goes on from other milling: {:.6g} mm^3 had been removed when it began",
                                  recorded_mm3));
  }
  refuse(recording, fmt::format("was made with another scan ({}) or version ({}): at tick {} it had removed "
                                "{:.9g} mm^3, where this one loses {:.9g}",
                                recording.description.scan_name, recording.description.program_version, tick,
                                recorded_mm3, removed_mm3));
}

}  // namespace

void repeat_milling(Volume& volume, const Recording& recording) {
  require_same_grid(recording, volume.geometry());
  if (recording.dropped > 0) {
    refuse(recording, fmt::format("lost {} ticks, so its milling cannot be repeated", recording.dropped));
  }
  const MillingSettings milling = milling_of(recording);
  BurrMill mill = make_mill(recording, milling, volume.geometry());
  double removed_mm3 = 0;
  for (std::size_t tick = 0; tick < recording.records.size(); ++tick) {
    const TickRecord& record = recording.records[tick];
    if (record.spindle_on) {
      const Vec3 paying_W_N = paying_force_W_N(milling, record.X_WT, record.burr_force_W_N);
      removed_mm3 += mill.step(volume, record.X_WT.position_mm, paying_W_N, record.dt_s).removed_mm3;
    }
    require_same_removal(recording, tick, removed_mm3);
  }
}

}  // namespace osteomill
