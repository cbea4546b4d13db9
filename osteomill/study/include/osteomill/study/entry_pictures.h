#pragma once

#include <optional>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/study/run_events.h"
#include "osteomill/visual/camera.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns how much of the surface that milling left, by the voxels along it, the camera sees: 1 if nothing
/// was milled. `milled` was the bone before and was only milled since. Not for the tick.
double share_seen(const Volume& before, const Volume& milled, const Camera& camera);

/// Takes PNGs of a bone from obliquely above an entry, before milling and after it, all from the same view,
/// those of a patient with the letters of the patient's directions. If OpenGL cannot be had there are none,
/// and a warning says so.
class EntryPictures {
 public:
  EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry,
                const RunEvents& events, bool of_patient = false);

  bool can_be_had() const { return before_.has_value(); }
  /// Returns a recording's picture of this name: before, after, or straight along the entry, which there is
  /// only if fewer than half of what milling left of the surface is seen in the others, as behind a ridge.
  /// Nothing if OpenGL failed since.
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
