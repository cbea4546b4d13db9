#pragma once

#include <filesystem>

#include "osteomill/exercise/exercise.h"
#include "osteomill/volume/volume.h"
#include "osteomill/volume/voxel_set.h"

namespace osteomill {

/// Returns the voxels of a region of a scan; empty if its shapes do not intersect. `file` is the exercise's;
/// recordings are relative to its folder. Throws InputError, naming the file and the region's line, if a
/// shape is outside the scan or a label is not in the label map; and, naming the recording, if one cannot be
/// read or belongs to another scan. Slow.
VoxelSet region_voxels(const Region& region, const Volume& scan, const std::filesystem::path& file);

/// Returns the voxels that are bone in `before` but not in `after`, which must have the same scan.
VoxelSet removed_voxels(const Volume& before, const Volume& after);

/// Returns the voxels without bone that are face-connected to the border of the scan. Excludes `walls`. Slow.
VoxelSet open_space(const Volume& bone, const VoxelSet& walls = {});
/// Returns the open space that the removal of `removed` added to `open_before`.
VoxelSet opened_space(const Volume& bone, const VoxelSet& open_before, const VoxelSet& removed,
                      const VoxelSet& walls);

/// Returns whether milling opened a passage through a structure: removed bone within it connects spaces next
/// to it that were not connected within it before. Slow.
bool is_cut_through(const VoxelSet& structure, const Volume& before, const Volume& after);

/// Returns the voxels of a set that are bone.
VoxelSet bone_within(const VoxelSet& voxels, const Volume& bone);

}  // namespace osteomill
