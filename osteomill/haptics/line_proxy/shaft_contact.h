#pragma once

#include <array>
#include <cstddef>

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
  /// bone that covers the shaft up to its end, the surface's normal.
  Vec3 out_W;
  /// How far the line must be moved that way.
  double depth_mm;
};

/// The contacts of one line, from the tip up: of each stretch in bone the apex, and places along it, so that
/// what lies along a face is held along it.
struct ShaftContacts {
  static constexpr std::size_t kStretches = 4;
  static constexpr std::size_t kPlaces = 7;
  static constexpr std::size_t kMax = kStretches * (1 + kPlaces);
  std::array<ShaftContact, kMax> all;
  std::size_t count = 0;
};

/// Whether any of the line's span lies in bone, looked at as for its contacts. Safe in the haptic tick.
bool shaft_in_bone(const Volume& volume, const ShaftSpan& span, const Pose& X_WL);

/// The contacts of the line through the origin of `X_WL` along its +z, of the first four stretches of it in
/// bone. The direction follows from the surface's normals where the line goes in and out; where they do
/// not tell, or would lead on, away from where the line was free before (`X_WL_before`), back there. The
/// apex is the mean of the stretch, weighted by how little less deep than its deepest it is, down to nothing
/// at `softness_mm` less: at an edge the edge, on a face what stands out, moving smoothly with the line. Safe
/// in the haptic tick.
ShaftContacts shaft_contacts(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                             const Pose& X_WL_before, const NormalRule& normal, double softness_mm);

}  // namespace osteomill::line_proxy
