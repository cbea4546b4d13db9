#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Bone removed in a tick from one label that the burr touched. `label` 0 means no entry.
struct LabelCut {
  LabelMap::LabelIndex label = 0;
  /// In mm^3 of reference density, as in MillingStep.
  double removed_mm3 = 0;
  friend bool operator==(const LabelCut&, const LabelCut&) = default;
};
/// Labels reported by one tick; unused entries, at the end, have label 0.
using LabelCuts = std::array<LabelCut, 4>;

/// Sums the bone removed per label until it is reported. Fixed size; safe in the haptic tick. A tick reports
/// at most four labels; further ones stay queued for the next ticks, so nothing is lost.
class LabelTally {
 public:
  /// Adds to the sum of a label. Ignores label 0.
  void add(LabelMap::LabelIndex label, double removed_mm3) noexcept {
    add_contact(label);
    if (label != 0) removed_mm3_[label] += removed_mm3;
  }
  /// Records contact with a label without removal. Ignores label 0.
  void add_contact(LabelMap::LabelIndex label) noexcept {
    if (label == 0 || is_queued_[label]) return;
    is_queued_[label] = true;
    queue_[count_++] = label;
  }

  /// Removes and returns the labels queued longest.
  LabelCuts take() noexcept {
    LabelCuts cuts;
    const std::size_t taken = std::min(cuts.size(), count_);
    for (std::size_t n = 0; n < taken; ++n) {
      const LabelMap::LabelIndex label = queue_[n];
      cuts[n] = {label, removed_mm3_[label]};
      removed_mm3_[label] = 0;
      is_queued_[label] = false;
    }
    std::copy(queue_.begin() + static_cast<std::ptrdiff_t>(taken),
              queue_.begin() + static_cast<std::ptrdiff_t>(count_), queue_.begin());
    count_ -= taken;
    return cuts;
  }

 private:
  std::array<double, LabelMap::kMaxLabels + 1> removed_mm3_{};
  std::array<bool, LabelMap::kMaxLabels + 1> is_queued_{};
  std::array<LabelMap::LabelIndex, LabelMap::kMaxLabels> queue_{};
  std::size_t count_ = 0;
};

}  // namespace osteomill
