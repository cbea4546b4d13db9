#pragma once

#include <string>
#include <vector>

#include "osteomill/base/field.h"

namespace osteomill {

/// The figures of how well a number of vertices represents surface-points' sphere, or one circle of its
/// shaft. Pressed in on a flat wall by half its radius, whatever side of it is turned to the wall, the force
/// should point out of the wall and always be the same; and no side should come far in unseen.
struct VertexSearchRow {
  /// "sphere" or "circle".
  std::string part;
  int vertices = 0;
  /// The angle between the force and the wall's normal, over the sides; 180 if nothing is felt.
  double direction_deg_median = 0;
  double direction_deg_worst = 0;
  /// The furthest that the force's size lies off its mean over the sides, as a share of that.
  double size_off_worst = 0;
  /// The deepest that a side gets before a vertex is in bone, as a share of the radius; at most 0.5.
  double unseen_worst = 0;
  /// True if all three worst values keep to the limits below.
  bool suffices = false;

  static constexpr double kMaxDirection_deg = 10;
  static constexpr double kMaxSizeOff = 0.2;
  static constexpr double kMaxUnseen = 0.2;
};

/// Returns the numbers of a row, the columns of vertices.csv behind the part.
template <>
const std::vector<Field<VertexSearchRow>>& fields_of<VertexSearchRow>();

/// Presses surface-points itself with 6 to 96 vertices on the sphere, 1000 sides each, and 3 to 32 on the
/// circle. The wall's density falls linearly through its surface, where (15) is exact, so that nothing but
/// the number of vertices counts. Returns rows in the order of part and number. Takes seconds.
std::vector<VertexSearchRow> search_vertices();

/// Returns the least number for this part from which on all tried suffice; 0 if there is none.
int least_vertices(const std::vector<VertexSearchRow>& rows, const std::string& part);

}  // namespace osteomill
