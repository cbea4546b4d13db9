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

// From the tip up.
std::optional<Stretch> first_stretch(const Line& line, const ShaftSpan& span) {
  const int samples = std::max(1, static_cast<int>((span.end_mm - span.start_mm) / span.sample_mm + 0.5));
  const double sample_mm = (span.end_mm - span.start_mm) / samples;
  double lower_mm = 0;
  bool inside = line.in_bone(0);
  for (int n = 0; n <= samples; ++n) {
    const double lever_mm = span.start_mm + n * sample_mm;
    const bool in_bone = line.in_bone(lever_mm);
    if (in_bone && !inside) lower_mm = line.crossing(n > 0 ? lever_mm - sample_mm : 0, lever_mm);
    if (!in_bone && inside && n > 0) {
      return Stretch{lower_mm, line.crossing(lever_mm, lever_mm - sample_mm), true};
    }
    inside = in_bone;
  }
  return inside ? std::optional(Stretch{lower_mm, span.end_mm, false}) : std::nullopt;
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
  return (sum - sum.dot(line.along_W) * line.along_W).normalized();
}

}  // namespace

bool shaft_in_bone(const Volume& volume, const ShaftSpan& span, const Pose& X_WL) {
  return first_stretch({volume, X_WL.position_mm, shaft_direction(X_WL)}, span).has_value();
}

std::optional<ShaftContacts> shaft_contacts(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                                            const NormalRule& normal, double reach_mm) {
  const Line line{volume, X_WL.position_mm, shaft_direction(X_WL)};
  const auto stretch = first_stretch(line, span);
  if (!stretch) return std::nullopt;
  const Vec3 out_W = way_out(line, *stretch, normal);
  ShaftContacts contacts;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const double share = (static_cast<double>(n) + 0.5) / static_cast<double>(contacts.size());
    const double lever_mm = stretch->lower_mm + share * (stretch->upper_mm - stretch->lower_mm);
    contacts[n] = {lever_mm, out_W,
                   depth_along(volume, line.at(lever_mm), out_W, reach_mm)
                       .value_or(std::numeric_limits<double>::infinity())};
  }
  return contacts;
}

}  // namespace osteomill::line_proxy
