#include "osteomill/haptics/line_proxy/shaft_contact.h"

#include <algorithm>
#include <limits>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

// A surface that a line grazes may seem to lean the wrong way by an error of its normal.
constexpr double kMinSlope = 0.02;

struct Line {
  const Volume& volume;
  Vec3 origin_W;
  Vec3 along_W;

  Vec3 at(double lever_mm) const { return origin_W + lever_mm * along_W; }
  bool in_bone(double lever_mm) const { return is_bone_at(volume, at(lever_mm)); }
  // Between a lever outside the bone and one inside.
  double crossing(double outside_mm, double inside_mm) const {
    return along_W.dot(bisect_crossing(volume, at(outside_mm), at(inside_mm)) - origin_W);
  }
};

// A stretch of the line in bone, its ends where the line passes the surface, or else the tip's and the
// shaft's.
struct Stretch {
  double lower_mm;
  double upper_mm;
  bool leaves;
};

// Calls `visit` with one stretch after the other until it answers false.
template <typename Visit>
void visit_stretches(const Line& line, const ShaftSpan& span, Visit visit) {
  const int samples = std::max(1, static_cast<int>((span.end_mm - span.start_mm) / span.sample_mm + 0.5));
  const double sample_mm = (span.end_mm - span.start_mm) / samples;
  double lower_mm = 0;
  bool inside = line.in_bone(0);
  for (int n = 0; n <= samples; ++n) {
    const double lever_mm = span.start_mm + n * sample_mm;
    const bool in_bone = line.in_bone(lever_mm);
    if (in_bone && !inside) lower_mm = line.crossing(n > 0 ? lever_mm - sample_mm : 0, lever_mm);
    if (!in_bone && inside && n > 0) {
      if (!visit(Stretch{lower_mm, line.crossing(lever_mm, lever_mm - sample_mm), true})) return;
    }
    inside = in_bone;
  }
  if (inside) visit(Stretch{lower_mm, span.end_mm, false});
}

// Where the line goes in and comes out, across edge and line; where its end is in, the normal.
Vec3 way_out(const Line& line, const Stretch& stretch, const NormalRule& rule) {
  const auto lower = surface_normal(line.volume, line.at(stretch.lower_mm), rule);
  if (!stretch.leaves) return lower.value_or(Vec3::Zero());
  const auto upper = surface_normal(line.volume, line.at(stretch.upper_mm), rule);
  if (!lower || !upper) return Vec3::Zero();
  const double lower_slope = std::max(kMinSlope, -lower->dot(line.along_W));
  const double upper_slope = std::max(kMinSlope, upper->dot(line.along_W));
  const Vec3 sum = upper_slope * *lower + lower_slope * *upper;
  const Vec3 across = sum - sum.dot(line.along_W) * line.along_W;
  // Through a thin wall the two surfaces look away from each other.
  return across.norm() > 0.2 * (lower_slope + upper_slope) ? across.normalized() : Vec3::Zero();
}

}  // namespace

bool shaft_in_bone(const Volume& volume, const ShaftSpan& span, const Pose& X_WL) {
  bool any = false;
  visit_stretches({volume, X_WL.position_mm, shaft_direction(X_WL)}, span, [&](const Stretch&) {
    any = true;
    return false;
  });
  return any;
}

ShaftContacts shaft_contacts(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                             const NormalRule& normal, double reach_mm) {
  const Line line{volume, X_WL.position_mm, shaft_direction(X_WL)};
  ShaftContacts contacts;
  visit_stretches(line, span, [&](const Stretch& stretch) {
    const Vec3 out_W = way_out(line, stretch, normal);
    for (std::size_t n = 0; n < ShaftContacts::kPlaces; ++n) {
      const double share = (static_cast<double>(n) + 0.5) / ShaftContacts::kPlaces;
      const double lever_mm = stretch.lower_mm + share * (stretch.upper_mm - stretch.lower_mm);
      contacts.all[contacts.count++] = {lever_mm, out_W,
                                        depth_along(volume, line.at(lever_mm), out_W, reach_mm)
                                            .value_or(std::numeric_limits<double>::infinity())};
    }
    return contacts.count < ShaftContacts::kMax;
  });
  return contacts;
}

}  // namespace osteomill::line_proxy
