#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "osteomill/volume/label_map.h"

namespace osteomill {

/// The bone that a tick took of one label that it touched. `label` 0 means no entry.
struct LabelCut {
  LabelMap::LabelIndex label = 0;
  /// In mm^3 of reference density, as MillingStep counts.
  double removed_mm3 = 0;
  friend bool operator==(const LabelCut&, const LabelCut&) = default;
};
/// The labels that a tick reports: first the entries, then empty ones.
using LabelCuts = std::array<LabelCut, 4>;

/// Sums what was taken of each label and not yet reported. Its size is fixed; safe in the haptic tick. A tick
/// reports a few labels; if a burr cuts more at once, the others wait for the next ticks, so that nothing is
/// lost.
class LabelTally {
 public:
  /// Adds to the sum of a label; does nothing for no label.
  void add(LabelMap::LabelIndex label, double removed_mm3) noexcept {
    add_contact(label);
    if (label != 0) removed_mm3_[label] += removed_mm3;
  }
  /// Notes that a label was touched, though nothing was taken of it; does nothing for no label.
  void add_contact(LabelMap::LabelIndex label) noexcept {
    if (label == 0 || waits_[label]) return;
    waits_[label] = true;
    waiting_[count_++] = label;
  }

  /// Takes out the labels that have waited longest.
  LabelCuts take() noexcept {
    LabelCuts cuts;
    const std::size_t taken = std::min(cuts.size(), count_);
    for (std::size_t n = 0; n < taken; ++n) {
      const LabelMap::LabelIndex label = waiting_[n];
      cuts[n] = {label, removed_mm3_[label]};
      removed_mm3_[label] = 0;
      waits_[label] = false;
    }
    std::copy(waiting_.begin() + static_cast<std::ptrdiff_t>(taken),
              waiting_.begin() + static_cast<std::ptrdiff_t>(count_), waiting_.begin());
    count_ -= taken;
    return cuts;
  }

 private:
  std::array<double, LabelMap::kMaxLabels + 1> removed_mm3_{};
  std::array<bool, LabelMap::kMaxLabels + 1> waits_{};
  std::array<LabelMap::LabelIndex, LabelMap::kMaxLabels> waiting_{};
  std::size_t count_ = 0;
};

}  // namespace osteomill
