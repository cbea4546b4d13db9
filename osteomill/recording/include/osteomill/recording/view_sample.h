#pragma once

#include <array>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/base/pose.h"

namespace osteomill {

/// Clipping plane of a view: hides points p of W with normal . p < offset. A zero normal clips nothing.
struct ViewClipPlane {
  Vec3 normal_W = Vec3::Zero();
  double offset_mm = 0;
};

/// View of the bone that a trainee had at one time of a session, and the guidance shown with it.
struct ViewSample {
  /// Time of the tick shown (TickRecord::time_s).
  double time_s = 0;
  /// Camera pose: x to the right, y up, z towards the viewer.
  Pose X_WC;
  /// Vertical field of view, and aspect ratio (width / height).
  double field_of_view_rad = 0.5;
  double aspect = 1;
  std::array<ViewClipPlane, 4> cuts;
  /// Current step of the exercise, from 1; 0 for none.
  int step = 0;
  /// True if steps, colours and distances were shown.
  bool has_guidance = false;
};

/// Returns the columns of a recording's views.
template <>
const std::vector<Field<ViewSample>>& fields_of<ViewSample>();

}  // namespace osteomill
