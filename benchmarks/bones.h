#pragma once

#include <functional>
#include <string>

#include "osteomill/base/pose.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::benchmarks {

/// Bones shared by the benchmarks; each is loaded once.
enum class Bone {
  builtin,            ///< built-in tooth, 256 x 256 x 176 voxels of 0.125 mm
  builtin_refined,    ///< the same, 512 x 512 x 352 of 0.0625 mm
  builtin_finest,     ///< the same, 1024 x 1024 x 704 of 0.031 mm
  real_tooth,         ///< ../shared/data/tooth_dicom at isovalue 755, 256 x 256 x 176
  real_tooth_refined  ///< the same sampled twice as finely, 512 x 512 x 352
};

std::string name_of(Bone bone);
/// Returns whether the scan is on this machine.
bool is_available(Bone bone);
const Volume& bone_volume(Bone bone);

/// Returns a block of bone that fills a 512 x 512 x 352 grid except for a margin, with a through hole along i
/// around the tool's shaft, of radius `shaft_radius_mm` - `overlap_mm`.
Volume sleeve_block(double spacing_mm, const MillingTool& tool, double overlap_mm);
/// Returns the pose of the tool in the middle of that hole.
Pose pose_in_sleeve(const Volume& block, const MillingTool& tool);

}  // namespace osteomill::benchmarks
