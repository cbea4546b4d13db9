#pragma once

#include <string>
#include <vector>

#include "osteomill/base/field.h"

namespace osteomill {

/// How well a number of vertices represents the sphere of surface-points, or one circle of its shaft. When
/// any side of it is pressed into a flat wall by half its radius, the force should be normal to the wall and
/// of the same magnitude, and no side should penetrate far before a vertex detects it.
struct VertexSearchRow {
  /// "sphere" or "circle".
  std::string part;
  int vertices = 0;
  /// Angle between the force and the wall's normal, over the sides; 180 if no force is felt.
  double direction_deg_median = 0;
  double direction_deg_worst = 0;
  /// Largest deviation of the force's magnitude from its mean over the sides, as a fraction of that mean.
  double size_off_worst = 0;
  /// Largest depth of a side before a vertex is in bone, as a fraction of the radius; at most 0.5.
  double unseen_worst = 0;
  /// True if all three worst values are within the limits below.
  bool suffices = false;

  static constexpr double kMaxDirection_deg = 10;
  static constexpr double kMaxSizeOff = 0.2;
  static constexpr double kMaxUnseen = 0.2;
};

/// Returns the numeric columns of vertices.csv, which follow `part`.
template <>
const std::vector<Field<VertexSearchRow>>& fields_of<VertexSearchRow>();

/// Presses surface-points itself with 6 to 96 vertices on the sphere, 1000 sides each, and 3 to 32 on the
/// circle. The wall's density falls linearly through its surface, for which (15) is exact, so that only the
/// number of vertices matters. Returns rows ordered by part and number. Takes seconds.
std::vector<VertexSearchRow> search_vertices();

/// Returns the smallest number of vertices for this part from which on all tried suffice; 0 if none.
int least_vertices(const std::vector<VertexSearchRow>& rows, const std::string& part);

}  // namespace osteomill
