#pragma once

#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Towards the corners, edges and faces of a cube: unit vectors.
inline constexpr int kCubeDirections = 26;
Vec3 cube_direction(int n);

/// Whether bone lies ahead of a burr that presses with this force, no more than a voxel off: in the force's
/// direction, or in those of a cube's that lie on that side. A wall beside a burr may hold it, but is not
/// what it presses on. Safe in the haptic tick.
bool burr_presses(const Volume& volume, const MillingTool& tool, const Pose& X_WT, const Vec3& force_W_N);

}  // namespace osteomill
