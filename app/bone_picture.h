#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "osteomill/device/milling_entry.h"
#include "osteomill/view/camera.h"
#include "osteomill/volume/volume.h"

namespace osteomill::app {

/// PNGs of a bone from obliquely above an entry, before milling and after it, all from the same view. Where
/// OpenGL cannot be had there are none, and standard error says so once.
class EntryPictures {
 public:
  EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry);

  const std::optional<std::vector<unsigned char>>& before() const { return before_; }
  /// Nothing where there was none before either, or OpenGL failed since.
  std::optional<std::vector<unsigned char>> of(const Volume& milled) const;

 private:
  double reference_density_;
  Camera camera_;
  std::optional<std::vector<unsigned char>> before_;
};

}  // namespace osteomill::app
