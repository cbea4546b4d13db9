#pragma once

#include <array>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/base/pose.h"

namespace osteomill {

/// A cut through a view: points p of W with normal . p < offset are not shown. A normal of zero cuts nothing.
struct ViewCut {
  Vec3 normal_W = Vec3::Zero();
  double offset_mm = 0;
};

/// The view of the bone that a trainee had at one time of a session, and the help that was shown with it.
struct ViewSample {
  /// The time of the tick that was shown (TickRecord::time_s).
  double time_s = 0;
  /// The eye, with x to the right, y up and z towards the viewer.
  Pose X_WC;
  /// The angle of view from bottom to top, and how many times as wide as high the picture is.
  double field_of_view_rad = 0.5;
  double aspect = 1;
  std::array<ViewCut, 4> cuts;
  /// The step of the exercise that was worked on, from 1; 0 for none.
  int step = 0;
  /// Whether steps, colours and distances were shown.
  bool has_guidance = false;
};

/// Returns the columns of a recording's views.
template <>
const std::vector<Field<ViewSample>>& fields_of<ViewSample>();

}  // namespace osteomill
