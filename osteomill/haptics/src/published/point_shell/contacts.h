#pragma once

#include "energy_sum.h"
#include "published/point_shell/voxel_shell.h"
#include "tool/sampled_distance_field.h"

namespace osteomill::point_shell {

/// Adds a point at `r_mm` from the burr's centre that is pushed with `push_N` along the unit vector `n` out
/// of the tool, and pushes the tool the other way; `stiffness_N_per_mm` is how the push grows with the depth.
/// The depth grows by n . dx + (r x n) . dw (the field's gradient, exactly), so each point adds k [n; r x
/// n][n; r x n]^T to the derivatives of eq. 22 and 23 (Barbic and James 2008). Left out is how n turns as the
/// tool moves, of the size of push / (radius of the tool): it would make the sum indefinite, and vanishes
/// with the depth.
void add_contact(EnergySum& sum, double push_N, double stiffness_N_per_mm, const Vec3& n, const Vec3& r_mm);

/// The contacts with the tool, summed for burr and shaft apart, in one frame's axes. With the tool moved by
/// dx (mm) and turned by dw (rad, about the burr's centre), what acts on it is -(gradient + convex [dx; dw]).
struct ToolContacts {
  EnergySum burr;
  EnergySum shaft;

  EnergySum total() const {
    EnergySum sum = burr;
    sum += shaft;
    return sum;
  }
};

/// Returns the height on the axis below which a contact is the burr's: where the shaft comes out of the
/// sphere, or the equator of a burr no wider than its shaft.
double burr_top_mm(const MillingTool& tool);

/// Finds the points of the shell that lie in the tool at `X_WT` and sums them in W's axes (Eriksson 2012, 6.2
/// and 6.3): boxes of the octree against the tool's bounding box, then each point of the boxes left against
/// the tool's sampled distance ("SPO", 6.1). A point at the depth d pushes with `stiffness_N_per_mm3` times
/// its area times d. Safe in the haptic tick.
ToolContacts contacts_by_octree(const VoxelShell& shell, const MillingTool& tool,
                                const SampledDistanceField& field, const Pose& X_WT,
                                double stiffness_N_per_mm3);

}  // namespace osteomill::point_shell
