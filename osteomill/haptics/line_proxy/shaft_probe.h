#pragma once

#include <optional>
#include <span>

#include "osteomill/geometry/pose.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// A point of the shaft's centreline and the density there.
struct ShaftProbe {
  Vec3 point_W;
  double density;
};

/// v_max of section 4.3: the densest point among the shaft's vertices (those of the tip left out) and among
/// the same vertices moved along b, from the intersection point of the tick before to the burr's centre (at
/// the proxy), in three further steps that together stay below the vertices' spacing. `vertices_T` is not
/// empty. Among equally dense ones (bone is often saturated inside) the middle one of the first unbroken run
/// along the shaft. Safe in the haptic tick.
ShaftProbe densest_point(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                         const Vec3& intersection_before_W);

/// An unbroken stretch of the shaft in bone: its first and last sample. The samples are the vertices and
/// three places between each two, numbered from 0.
struct ShaftRun {
  int first;
  int last;
};

/// The run nearest along the shaft to `near_W`; nothing where no sample is in bone. Safe in the haptic tick.
std::optional<ShaftRun> nearest_run(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                                    const Vec3& near_W);

/// The place of a sample, or of anything between two samples, in W. Safe in the haptic tick.
Vec3 sample_W(std::span<const Vec3> vertices_T, const Pose& X_WT, double sample);

/// The middle of a run (a sample number), each sample weighted by its density above the isovalue: a probe
/// that moves smoothly with the pose, where the densest point leaps from sample to sample. Safe in the haptic
/// tick.
double middle_of(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                 const ShaftRun& run);

/// The end of the bone over the place of a run at which the shaft must be moved furthest along `out_W` (unit,
/// across the shaft) to come free: at an edge, the edge. It is looked for up and down the shaft from
/// `middle`, as far as the end of the bone goes on without a leap (beyond one lies another surface).
/// Near-equal depths are averaged, so that the place moves smoothly with the pose. Nothing where over the
/// middle the bone goes on for more than `limit_mm`. Safe in the haptic tick: the time grows with `limit_mm`.
std::optional<Vec3> deepest_across(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                                   const ShaftRun& run, double middle, const Vec3& out_W, double limit_mm);

/// How many of the vertices lie in bone.
int vertices_in_bone(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT);

}  // namespace osteomill::line_proxy
