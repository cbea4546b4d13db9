#pragma once

#include <filesystem>

#include "osteomill/exercise/exercise.h"
#include "osteomill/volume/volume.h"
#include "osteomill/volume/voxel_set.h"

namespace osteomill {

/// Returns the voxels of a region of a scan; none if its shapes have nothing in common. `file` is the
/// exercise's, in whose folder recordings lie. Throws InputError, naming the file and the region's line, if a
/// shape lies outside the scan or a label is not in its map; and, naming the recording, if one cannot be read
/// or is of another scan. Long work.
VoxelSet region_voxels(const Region& region, const Volume& scan, const std::filesystem::path& file);

/// Returns the voxels that are bone in `before` and no bone in `after`, which is a bone of the same scan.
VoxelSet removed_voxels(const Volume& before, const Volume& after);

/// Returns the voxels without bone that are connected to the border of the scan by their faces. Voxels of
/// `walls` are in no way part of it. Long work.
VoxelSet open_space(const Volume& bone, const VoxelSet& walls = {});
/// Returns the voxels that are such space because the bone of `removed` is gone, given the space before.
VoxelSet opened_space(const Volume& bone, const VoxelSet& open_before, const VoxelSet& removed,
                      const VoxelSet& walls);

/// Returns whether milling opened a way through a structure: removed bone within it joins spaces beside it
/// that nothing within it joined before. Long work.
bool is_cut_through(const VoxelSet& structure, const Volume& before, const Volume& after);

/// Returns the part of a set that is bone.
VoxelSet bone_within(const VoxelSet& voxels, const Volume& bone);

}  // namespace osteomill
