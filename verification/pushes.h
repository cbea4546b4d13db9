#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "verification/bone_surface.h"

namespace osteomill::verification {

/// Tool, forces and speeds of random pushes by a hand.
struct PushKind {
  MillingTool tool;
  double min_N = 2;
  double max_N = 10;
  double min_mm_s = 20;
  double max_mm_s = 300;
};

/// Largest and final depth past the surface, mm; negative outside.
struct Depth {
  double max_mm = -1;
  double final_mm = -1;

  void record(double deep_mm) {
    final_mm = deep_mm;
    max_mm = std::max(max_mm, deep_mm);
  }
};

/// Depths of the simulated tool, taken as its centreline and with its radii.
struct PushOutcome {
  Depth centreline;
  Depth tool;
};

inline constexpr int kTicksBetweenChecks = 4;

/// Pushes towards random points of the bone's surface, from any side and in any pose, starting in free space.
/// Every algorithm gets the same pushes. Depths are checked every `kTicksBetweenChecks` ticks, independently
/// of the algorithm.
std::vector<PushOutcome> push_outcomes(std::string_view algorithm, const Volume& bone,
                                       const BoneSurface& surface, const PushKind& kind, int count);

/// Counts the outcomes of which the selected depth exceeds `limit_mm`.
std::size_t count_deeper(const std::vector<PushOutcome>& all, Depth PushOutcome::*what, double Depth::*when,
                         double limit_mm);

}  // namespace osteomill::verification
