#pragma once

#include <optional>
#include <span>

#include "osteomill/base/pose.h"
#include "osteomill/volume/volume.h"

/// First position of the intersection point of section 4.3, and the point that it follows. Safe in the haptic
/// tick.
namespace osteomill::line_proxy {

/// Numbers of steps for translation and rotation in the walk (each at least 1).
struct WalkSteps {
  int translation;
  int rotation;
};

/// The most active vertex at the first step n of the walk at which any vertex collides.
struct WalkHit {
  /// Its positions at step n-1 and step n, in W.
  Vec3 before_W;
  Vec3 at_W;
  /// Eq. 1, the smallest of the active vertices: 0 to 1 if it was outside before; any value, even not finite,
  /// if it was already in bone.
  double fraction;

  /// Eq. 2: the intersection point IP.
  Vec3 intersection_W() const { return before_W + fraction * (at_W - before_W); }
};

/// Performs the translation/rotation walk of section 4.3 from the previous tick's pose to the current one:
/// first the whole translation, then the whole rotation (by the smaller angle, about the tip), step by step
/// until a vertex of the shaft collides. `vertices_T` are the shaft's, without the tip's vertex, which has
/// its own proxy. Returns nothing if none collides. Safe in the haptic tick.
std::optional<WalkHit> walk_to_collision(const Volume& volume, std::span<const Vec3> vertices_T,
                                         const Pose& X_WT_before, const Pose& X_WT, const WalkSteps& steps);

/// A point on the shaft's centreline and its density.
struct ShaftProbe {
  Vec3 point_W;
  double density;
};

/// Returns v_max of section 4.3: the densest point among the shaft's vertices (without the tip's) and the
/// same vertices shifted along b, from the previous intersection point to the burr's centre (at the proxy),
/// in three further steps that together stay below the vertex spacing. `vertices_T` must not be empty. Among
/// equally dense points (bone is often saturated inside) returns the middle of the first unbroken run along
/// the shaft. Safe in the haptic tick.
ShaftProbe densest_point(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                         const Vec3& intersection_before_W);

}  // namespace osteomill::line_proxy
