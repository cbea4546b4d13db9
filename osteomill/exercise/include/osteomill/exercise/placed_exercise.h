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
  /// The shortest distance of the target from the structure, mm.
  double from_target_mm = 0;
};

/// An exercise on its scan.
struct PlacedExercise {
  Exercise exercise;
  GridGeometry scan;
  /// The bone to be removed.
  VoxelSet target;
  /// The axis of W, or its opposite, into which the target's surface faces.
  Vec3 outward_W = Vec3::UnitZ();
  /// Every voxel that may be removed: the target, and all within the margin around it.
  VoxelSet allowed;
  /// Bone that must stay, of the region that the exercise names.
  VoxelSet keep;
  std::vector<PlacedStructure> structures;
  /// Their distances, one for each, which the bone carries to the haptic tick (Volume::no_go).
  std::shared_ptr<const NoGoDistances> distances = std::make_shared<NoGoDistances>();
  /// The bone of each step.
  std::vector<VoxelSet> steps;

  /// Returns whether removing a voxel's bone counts as outside.
  bool is_outside(const VoxelIndex& v) const { return !allowed.contains(v) || keep.contains(v); }
  double volume_mm3(std::size_t voxels) const {
    return static_cast<double>(voxels) * scan.voxel_volume_mm3();
  }
};

/// Places an exercise on its scan. Throws InputError, naming the file and the line, as `region_voxels` does
/// and if the target holds no bone, overlaps a structure that must not be touched, or a step or a structure
/// is empty. Long work.
PlacedExercise place_exercise(const Exercise& exercise, const Volume& scan);

/// Returns a label map of the scan that colours the target, the structures and the bone to be kept.
std::shared_ptr<const LabelMap> colours_of(const PlacedExercise& placed);

/// Returns lines for people: the target and its volume, structures and distances, steps and items.
std::vector<std::string> describe(const PlacedExercise& placed);

}  // namespace osteomill
