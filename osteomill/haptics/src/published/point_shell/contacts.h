#pragma once

#include "energy_sum.h"
#include "published/point_shell/voxel_shell.h"
#include "tool/sampled_distance_field.h"

namespace osteomill::point_shell {

/// Adds a contact at `r_mm` from the burr's centre: the tool pushes the point with `push_N` along `n`, the
/// unit vector out of the tool, and is pushed back equally. `stiffness_N_per_mm` is the derivative of the
/// push with respect to depth. The depth grows by n . dx + (r x n) . dw (exactly the field's gradient), so
/// each point adds k [n; r x n][n; r x n]^T to the derivatives of eq. 22 and 23 (Barbic and James 2008).
/// Neglects the rotation of n as the tool moves, of the order of push / (radius of the tool): it would make
/// the sum indefinite, and vanishes with the depth.
void add_contact(EnergySum& sum, double push_N, double stiffness_N_per_mm, const Vec3& n, const Vec3& r_mm);

/// Contacts with the tool, summed separately for burr and shaft, in the axes of one frame. After the tool
/// moves by dx (mm) and rotates by dw (rad, about the burr's centre), the wrench on it is -(gradient + convex
/// [dx; dw]).
struct ToolContacts {
  EnergySum burr;
  EnergySum shaft;

  EnergySum total() const {
    EnergySum sum = burr;
    sum += shaft;
    return sum;
  }
};

/// Returns the height on the axis below which a contact counts as the burr's: where the shaft emerges from
/// the sphere, or the equator of a burr no wider than its shaft.
double burr_top_mm(const MillingTool& tool);

/// Finds the points of the shell inside the tool at `X_WT` and sums them in W's axes (Eriksson 2012, 6.2 and
/// 6.3): tests octree boxes against the tool's bounding box, then each point in the remaining boxes against
/// the tool's sampled distance ("SPO", 6.1). A point at depth d pushes with `stiffness_N_per_mm3` times its
/// area times d. Safe in the haptic tick.
ToolContacts contacts_by_octree(const VoxelShell& shell, const MillingTool& tool,
                                const SampledDistanceField& field, const Pose& X_WT,
                                double stiffness_N_per_mm3);

}  // namespace osteomill::point_shell
