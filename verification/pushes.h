#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "verification/bone_surface.h"

namespace osteomill::verification {

/// Pushes of a handle by a hand: how hard, how fast, with which tool.
struct PushKind {
  MillingTool tool;
  double min_N = 2;
  double max_N = 10;
  double min_mm_s = 20;
  double max_mm_s = 300;
};

/// How far past the surface something came, at any time and at the end.
struct Depth {
  double ever_mm = -1;
  double at_end_mm = -1;

  void look(double deep_mm) {
    at_end_mm = deep_mm;
    ever_mm = std::max(ever_mm, deep_mm);
  }
};

/// How deep the simulated tool came, as its centreline and with its radii.
struct PushOutcome {
  Depth centreline;
  Depth tool;
};

inline constexpr int kTicksBetweenLooks = 4;

/// Returns the outcomes of pushes against a bone, equal for each algorithm: towards random points of its
/// surface, from any side and in any pose, each begun in free space; checked every `kTicksBetweenLooks` ticks
/// independently of the algorithm.
std::vector<PushOutcome> push_outcomes(std::string_view algorithm, const Volume& bone,
                                       const BoneSurface& surface, const PushKind& kind, int count);

/// Returns how many came deeper than `limit_mm` at some time or at the end.
std::size_t count_deeper(const std::vector<PushOutcome>& all, Depth PushOutcome::*what, double Depth::*when,
                         double limit_mm);

}  // namespace osteomill::verification
