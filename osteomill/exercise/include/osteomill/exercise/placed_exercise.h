#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/exercise/exercise.h"
#include "osteomill/volume/label_map.h"
#include "osteomill/volume/structure_distance.h"
#include "osteomill/volume/volume.h"
#include "osteomill/volume/voxel_set.h"

namespace osteomill {

struct PlacedStructure {
  std::string name;
  double warn_mm = 3;
  std::optional<double> guard_mm = {};
  VoxelSet voxels;
  /// Shortest distance between the target and the structure, mm.
  double from_target_mm = 0;
};

/// An exercise with its regions as voxels of its scan.
struct PlacedExercise {
  Exercise exercise;
  GridGeometry scan;
  /// The bone to be removed.
  VoxelSet target;
  /// Direction out of the bone at the target: plus or minus z of W, or the
  /// larger of x and y if the direction is closer to horizontal than 30 degrees.
  Vec3 outward_W = Vec3::UnitZ();
  /// Voxels that may be removed: the target and the margin around it.
  VoxelSet allowed;
  /// Bone that must stay, from the exercise's `keep` region.
  VoxelSet keep;
  std::vector<PlacedStructure> structures;
  /// Distance function of each structure; the bone passes them to the haptic tick (Volume::no_go).
  std::shared_ptr<const NoGoDistances> distances = std::make_shared<NoGoDistances>();
  /// Bone of each step.
  std::vector<VoxelSet> steps;

  /// Returns whether removing a voxel's bone counts as outside the target.
  bool is_outside(const VoxelIndex& v) const { return !allowed.contains(v) || keep.contains(v); }
  double volume_mm3(std::size_t voxels) const {
    return static_cast<double>(voxels) * scan.voxel_volume_mm3();
  }
};

/// Converts an exercise's regions to voxels of its scan. Throws InputError, naming the file and the line, as
/// `region_voxels` and if the target holds no bone or overlaps a structure or the bone to be kept, or if a
/// step, a structure or `keep` is empty. Slow.
PlacedExercise place_exercise(const Exercise& exercise, const Volume& scan);

/// Returns a label map of the scan with the target, the bone to be kept and the structures.
std::shared_ptr<const LabelMap> colours_of(const PlacedExercise& placed);

/// Returns lines for people: the target and its volume, structures and distances, steps and items.
std::vector<std::string> describe(const PlacedExercise& placed);

}  // namespace osteomill
