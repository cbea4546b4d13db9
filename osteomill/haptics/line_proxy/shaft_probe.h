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

/// How many of the vertices lie in bone.
int vertices_in_bone(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT);

}  // namespace osteomill::line_proxy
