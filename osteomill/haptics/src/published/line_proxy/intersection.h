#pragma once

#include <optional>
#include <span>

#include "osteomill/base/pose.h"
#include "osteomill/volume/volume.h"

/// Finds where the intersection point of section 4.3 begins, and what it follows. Safe in the haptic tick.
namespace osteomill::line_proxy {

/// Into how many steps the walk divides the translation and the rotation (each at least 1).
struct WalkSteps {
  int translation;
  int rotation;
};

/// The most active vertex at the first step n of the walk at which any vertex collides.
struct WalkHit {
  /// Its places at step n-1 and at step n, in W.
  Vec3 before_W;
  Vec3 at_W;
  /// Eq. 1, the smallest of the active vertices: 0 to 1 if it was outside before; anything, also not
  /// finite, if it was in bone already.
  double fraction;

  /// Eq. 2: the intersection point IP.
  Vec3 intersection_W() const { return before_W + fraction * (at_W - before_W); }
};

/// The translation/rotation method of section 4.3: from the pose of the tick before to that of this tick,
/// first the whole translation, then the whole rotation (the shorter way round, about the tip), step by step
/// until a vertex of the shaft collides. `vertices_T` are the shaft's; the tip's vertex has a proxy of its
/// own and takes no part. Nothing if none collides on the way. Safe in the haptic tick.
std::optional<WalkHit> walk_to_collision(const Volume& volume, std::span<const Vec3> vertices_T,
                                         const Pose& X_WT_before, const Pose& X_WT, const WalkSteps& steps);

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

}  // namespace osteomill::line_proxy
