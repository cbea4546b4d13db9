#pragma once

#include <algorithm>
#include <cstddef>

namespace osteomill {

/// How many triangles may be drawn for one picture so that pictures follow each other quickly, from how long
/// those before took. No clock of its own.
class DrawingPace {
 public:
  /// Leaves room in a thirtieth of a second for the tool, the panels and showing it all.
  static constexpr double kBone_s = 0.018;
  static constexpr std::size_t kFewest = 20'000;

  std::size_t triangles() const {
    return std::max(kFewest, static_cast<std::size_t>(kBone_s / s_per_triangle_));
  }
  /// So many took so long. Pictures of a few say nothing of what many take.
  void drew(std::size_t triangles, double passed_s) {
    const double here = passed_s / static_cast<double>(std::max(triangles, kFewest));
    // One that others of the machine held up counts little.
    s_per_triangle_ += kWeight * (std::min(here, 2 * s_per_triangle_) - s_per_triangle_);
  }

 private:
  static constexpr double kWeight = 0.3;
  double s_per_triangle_ = kBone_s / 150'000;
};

}  // namespace osteomill
