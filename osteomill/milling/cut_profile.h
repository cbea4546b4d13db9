#pragma once

#include <algorithm>

namespace osteomill {

/// The density that cutting leaves `t` voxels outside a cut surface (inside it where negative), counted along
/// the surface's normal: the isovalue on it, the surroundings one voxel inside, as much above the isovalue
/// one voxel outside, and from there on so steep that bone soon stays as it is. It does not depend on what
/// was there, so cutting to the same surface again changes nothing. docs/algorithms.md.
struct CutProfile {
  float surroundings = 0;
  float isovalue = 0.5f;
  float per_voxel = 0.5f;
  float beyond_per_voxel = 4;

  /// How far outside the surface bone is lowered, if it is not more than three times as dense as the
  /// reference.
  static constexpr double kReach_voxels = 1.55;

  /// The isovalue and the reference are above the surroundings.
  static CutProfile between(double surroundings, double isovalue, double reference) {
    return {static_cast<float>(surroundings), static_cast<float>(isovalue),
            static_cast<float>(isovalue - surroundings), static_cast<float>(4 * (reference - surroundings))};
  }
  float density(float t) const {
    return std::max(surroundings, isovalue + per_voxel * t + beyond_per_voxel * std::max(0.0f, t - 1));
  }
};

}  // namespace osteomill
