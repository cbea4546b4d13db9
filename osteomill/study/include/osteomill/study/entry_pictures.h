#pragma once

#include <optional>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/study/run_events.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns the fraction of the surface exposed by milling, counted in voxels, that the camera sees; 1 if no
/// bone was removed. `milled` must be `before` with bone removed. Not real-time safe.
double visible_fraction(const Volume& before, const Volume& milled, const Camera& camera);

/// Renders PNGs of a bone from obliquely above an entry, before and after milling, from the same view, with
/// direction letters if the bone is a patient's. Renders none, with a warning, if OpenGL is not available.
class EntryPictures {
 public:
  EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry,
                const RunEvents& events, bool of_patient = false);

  bool is_available() const { return before_.has_value(); }
  /// Returns a recording's picture of this name: before, after, or straight along the entry. The last exists
  /// only if the others show less than half of the milled surface, e.g. behind a ridge. Returns nothing if
  /// OpenGL has failed since construction.
  std::optional<std::vector<unsigned char>> of(std::string_view name, const Volume& milled,
                                               const RunEvents& events) const;

 private:
  Volume bone_;
  MillingEntry entry_;
  double reference_density_;
  bool of_patient_;
  Camera camera_;
  std::optional<std::vector<unsigned char>> before_;
};

}  // namespace osteomill
