#pragma once

#include <array>
#include <optional>

#include "osteomill/geometry/pose.h"
#include "osteomill/haptics/line_proxy/bone_surface.h"
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
  /// bone that covers the shaft up to its end, the surface's normal. Zero where the surface does not tell.
  Vec3 out_W;
  /// How far the line must be moved that way; infinite where that is not known.
  double depth_mm;
};

/// The contacts of one line: places along the first stretch in bone from the tip up, so that what lies along
/// a face is held along it, and what stands on an edge at the deepest of them.
using ShaftContacts = std::array<ShaftContact, 12>;

/// Whether any of the line's span lies in bone, looked at as for its contacts. Safe in the haptic tick.
bool shaft_in_bone(const Volume& volume, const ShaftSpan& span, const Pose& X_WL);

/// The contacts of the line through the origin of `X_WL` along its +z, no deeper than `reach_mm`; nothing
/// where it is free. The direction follows from the surface's normals where the line goes in and out. Safe in
/// the haptic tick.
std::optional<ShaftContacts> shaft_contacts(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                                            const NormalRule& normal, double reach_mm);

}  // namespace osteomill::line_proxy
