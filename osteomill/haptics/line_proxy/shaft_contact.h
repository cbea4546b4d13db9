#pragma once

#include <optional>

#include "osteomill/geometry/pose.h"
#include "osteomill/haptics/line_proxy/surface_normal.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// The part of the centreline that can touch: from `start_mm` to `end_mm` up the shaft from the tip, looked
/// at every `sample_mm`.
struct ShaftSpan {
  double start_mm;
  double end_mm;
  double sample_mm;
};

/// Where a line lies in bone, and how it comes free.
struct ShaftContact {
  /// How far up the shaft from the tip.
  double lever_mm;
  /// The unit direction in W that leads out: on an edge across edge and shaft, on the shaft's end, or on
  /// bone that covers the shaft up to its end, the surface's normal.
  Vec3 out_W;
  /// How far the line must be moved that way.
  double depth_mm;
};

/// The contact of the line through the origin of `X_WL` along its +z, on the stretch in bone nearest to
/// `near_mm`; nothing where the span is free, or where no way out is found (`out_before_W`, a unit vector or
/// zero, is taken where the bone itself does not tell). The direction follows from the surface's normals
/// where the line goes in and out, and the place is the mean of that stretch, weighted by how little less
/// deep than its deepest it is, down to nothing at `softness_mm` less: at an edge the edge, on a face what
/// stands out, moving smoothly with the line. Safe in the haptic tick.
std::optional<ShaftContact> shaft_contact(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                                          double near_mm, const Vec3& out_before_W, const NormalRule& normal,
                                          double softness_mm);

}  // namespace osteomill::line_proxy
