#include "osteomill/haptics/line_proxy/shaft_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

struct Line {
  const Volume& volume;
  Vec3 origin_W;
  Vec3 along_W;

  Vec3 at(double lever_mm) const { return origin_W + lever_mm * along_W; }
  double above_isovalue(const Vec3& point_W) const {
    return density_at(volume.grid(), point_W) - volume.isovalue();
  }
  bool in_bone(double lever_mm) const { return above_isovalue(at(lever_mm)) > 0.0; }
  // Between a lever outside the bone and one inside.
  double crossing(double outside_mm, double inside_mm) const {
    return along_W.dot(bisect_crossing(volume, at(outside_mm), at(inside_mm)) - origin_W);
  }
};

// A stretch of the line in bone; whether it goes in above its lower end, and comes out below its upper end.
struct Stretch {
  double lower_mm = 0;
  double upper_mm = 0;
  bool enters = false;
  bool leaves = false;
};

// The first stretches of the span in bone, at most so many, their ends to where the line passes the surface.
class Stretches {
 public:
  Stretches(const Line& line, const ShaftSpan& span, std::size_t most = ShaftContacts::kStretches)
      : line_(line), span_(span) {
    const int samples = static_cast<int>((span.end_mm - span.start_mm) / span.sample_mm + 0.5);
    sample_mm_ = (span.end_mm - span.start_mm) / std::max(1, samples);
    Stretch current;
    // The two samples before.
    double before = 0;
    double above = 0;
    for (int n = 0; n <= samples + 1 && count_ < most; ++n) {
      const double lever_mm = span.start_mm + n * sample_mm_;
      const double next = n <= samples ? line.above_isovalue(line.at(lever_mm)) : 0;
      if (next > 0) {
        if (!(above > 0)) current = {lever_mm, lever_mm, n > 0, false};
        current.upper_mm = lever_mm;
        current.leaves = n < samples;
      } else if (above > 0) {
        all_[count_++] = to_the_surface(current);
      } else if (n >= 2 && n <= samples && above >= before && above >= next) {
        add_peak(lever_mm - sample_mm_, before, above, next);
      }
      before = above;
      above = next;
    }
  }
  bool empty() const { return count_ == 0; }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.begin() + static_cast<std::ptrdiff_t>(count_); }

 private:
  // Between samples that are all outside, an edge that stands out.
  void add_peak(double lever_mm, double before, double at, double after) {
    const double bend = before - 2 * at + after;
    if (!(bend < 0) || at - (after - before) * (after - before) / (8 * bend) <= 0) return;
    const double peak_mm = lever_mm - 0.5 * sample_mm_ * (after - before) / bend;
    if (line_.in_bone(peak_mm)) all_[count_++] = to_the_surface({peak_mm, peak_mm, true, true});
  }

  Stretch to_the_surface(Stretch stretch) const {
    if (stretch.enters) {
      stretch.lower_mm = line_.crossing(stretch.lower_mm - sample_mm_, stretch.lower_mm);
    } else if (!line_.in_bone(0.0)) {
      // The line may come out of the bone between the span and the tip.
      stretch.enters = true;
      stretch.lower_mm = line_.crossing(0.0, stretch.lower_mm);
    }
    if (stretch.leaves) stretch.upper_mm = line_.crossing(stretch.upper_mm + sample_mm_, stretch.upper_mm);
    return stretch;
  }

  const Line& line_;
  const ShaftSpan& span_;
  double sample_mm_ = 0;
  std::array<Stretch, ShaftContacts::kStretches> all_;
  std::size_t count_ = 0;
};

// Out of the bone at the stretch's ends, and how steeply each end's surface stands against the line.
struct WayOut {
  Vec3 out_W = Vec3::Zero();
  // What a wedge of bone between the two surfaces would be deep at most.
  double wedge_depth_mm = 0.0;
};

// A surface that a line grazes may seem to lean the wrong way by an error of its normal.
constexpr double kMinSlope = 0.02;

std::optional<WayOut> way_out_between(const Line& line, const Stretch& stretch, const Vec3& lower,
                                      const Vec3& upper) {
  const double lower_slope = std::max(kMinSlope, -lower.dot(line.along_W));
  const double upper_slope = std::max(kMinSlope, upper.dot(line.along_W));
  const Vec3 sum = upper_slope * lower + lower_slope * upper;
  const Vec3 across = sum - sum.dot(line.along_W) * line.along_W;
  const double size = across.norm();
  // Through a thin wall the two surfaces look away from each other.
  if (!(size > 0.2 * (lower_slope + upper_slope))) return std::nullopt;
  const Vec3 out_W = across / size;
  // As deep as each surface where the other end is, shared out.
  const double lower_rise = lower_slope / std::max(0.1, lower.dot(out_W));
  const double upper_rise = upper_slope / std::max(0.1, upper.dot(out_W));
  const double depth_mm =
      (stretch.upper_mm - stretch.lower_mm) * lower_rise * upper_rise / (lower_rise + upper_rise);
  return WayOut{out_W, depth_mm};
}

std::optional<WayOut> way_out(const Line& line, const Stretch& stretch, const NormalRule& rule) {
  // Where the line is in bone from its tip on, the tip lies just under the surface it rests on.
  const auto lower = surface_normal(line.volume, line.at(stretch.enters ? stretch.lower_mm : 0.0), rule);
  const auto upper =
      stretch.leaves ? surface_normal(line.volume, line.at(stretch.upper_mm), rule) : std::nullopt;
  const double length_mm = stretch.upper_mm - stretch.lower_mm;
  if (lower && upper) return way_out_between(line, stretch, *lower, *upper);
  if (lower) return WayOut{*lower, std::max(0.0, -lower->dot(line.along_W)) * length_mm};
  if (upper) return WayOut{*upper, std::max(0.0, upper->dot(line.along_W)) * length_mm};
  return std::nullopt;
}

// How far from a point in bone along `out_W` the bone ends; nothing beyond the limit.
std::optional<double> depth_along(const Line& line, const Vec3& point_W, const Vec3& out_W, double limit_mm) {
  const double step_mm = 0.5 * line.volume.geometry().spacing_mm.minCoeff();
  double above_before = line.above_isovalue(point_W);
  if (!(above_before > 0.0)) return 0.0;
  for (double depth_mm = step_mm; depth_mm < limit_mm + step_mm; depth_mm += step_mm) {
    const double above = line.above_isovalue(point_W + depth_mm * out_W);
    if (above > 0.0) {
      above_before = above;
      continue;
    }
    // Along half a voxel the density is nearly a parabola: once more by the chord.
    const double chord_mm = depth_mm - step_mm * above / (above - above_before);
    const double at_chord = line.above_isovalue(point_W + chord_mm * out_W);
    if (at_chord > 0.0)
      return at_chord == above ? chord_mm : chord_mm + (depth_mm - chord_mm) * at_chord / (at_chord - above);
    const double inner_mm = depth_mm - step_mm;
    return inner_mm + (chord_mm - inner_mm) * above_before / (above_before - at_chord);
  }
  return std::nullopt;
}

constexpr int kPlaces = 20;

class WeightedMean {
 public:
  void add(double weight, double lever_mm, double depth_mm) {
    weights_ += weight;
    levers_ += weight * lever_mm;
    depths_ += weight * depth_mm;
  }
  double lever_mm() const { return levers_ / weights_; }
  double depth_mm() const { return depths_ / weights_; }

 private:
  double weights_ = 0.0;
  double levers_ = 0.0;
  double depths_ = 0.0;
};

// How far the line was from the middle of the stretch when it was free, across itself unless the end is in.
Vec3 way_back(const Line& line, const Stretch& stretch, const Pose& X_WL_before) {
  const double lever_mm = 0.5 * (stretch.lower_mm + stretch.upper_mm);
  const Vec3 back = X_WL_before * Vec3(0, 0, lever_mm) - line.at(lever_mm);
  return stretch.leaves ? Vec3(back - back.dot(line.along_W) * line.along_W) : back;
}

void add_contacts(const Line& line, const Stretch& stretch, const Pose& X_WL_before, const NormalRule& normal,
                  double softness_mm, ShaftContacts& contacts) {
  // Less is rounding, and leads nowhere.
  constexpr double kWayBack_mm = 0.01;
  const double voxel_mm = line.volume.geometry().spacing_mm.minCoeff();
  const double length_mm = stretch.upper_mm - stretch.lower_mm;
  const Vec3 back_W = way_back(line, stretch, X_WL_before);
  const double back_mm = back_W.norm();
  auto way = way_out(line, stretch, normal);
  if (back_mm > kWayBack_mm && (!way || way->out_W.dot(back_W) < 0))
    way = WayOut{back_W / back_mm, length_mm};
  if (!way) return;
  const auto add = [&](double lever_mm, double depth_mm) {
    contacts.all[contacts.count++] = {lever_mm, way->out_W, depth_mm};
  };
  // Further than this lies another surface; a line along a face is as deep as it was laid.
  const double limit_mm = 2.0 * (way->wedge_depth_mm + softness_mm) + voxel_mm;

  std::array<double, kPlaces> depths_mm{};
  double deepest_mm = 0.0;
  const auto lever_of = [&](int n) { return stretch.lower_mm + (n + 0.5) / kPlaces * length_mm; };
  for (int n = 0; n < kPlaces; ++n) {
    double& depth_mm = depths_mm[static_cast<std::size_t>(n)];
    depth_mm = depth_along(line, line.at(lever_of(n)), way->out_W, limit_mm).value_or(0.0);
    deepest_mm = std::max(deepest_mm, depth_mm);
  }
  const double window_mm = std::min(softness_mm, deepest_mm);
  // No surface that way: back by what it came.
  if (!(window_mm > 0.0)) {
    add(0.5 * (stretch.lower_mm + stretch.upper_mm), back_mm);
    return;
  }
  WeightedMean blunt;
  WeightedMean sharp;
  for (int n = 0; n < kPlaces; ++n) {
    const double depth_mm = depths_mm[static_cast<std::size_t>(n)];
    const double share = 1.0 - (deepest_mm - depth_mm) / window_mm;
    if (!(share > 0.0)) continue;
    blunt.add(share, lever_of(n), depth_mm);
    sharp.add(share * share * share, lever_of(n), depth_mm);
  }
  // On a wedge the means with the first and the third power are off its apex as 5 to 3.
  const double lever_mm = 2.5 * sharp.lever_mm() - 1.5 * blunt.lever_mm();
  const double depth_mm = 2.5 * sharp.depth_mm() - 1.5 * blunt.depth_mm();
  add(std::clamp(lever_mm, stretch.lower_mm, stretch.upper_mm), depth_mm);
  for (int n = 1; n < kPlaces; n += 3) add(lever_of(n), depths_mm[static_cast<std::size_t>(n)]);
}

}  // namespace

bool shaft_in_bone(const Volume& volume, const ShaftSpan& span, const Pose& X_WL) {
  return !Stretches({volume, X_WL.position_mm, shaft_direction(X_WL)}, span, 1).empty();
}

ShaftContacts shaft_contacts(const Volume& volume, const ShaftSpan& span, const Pose& X_WL,
                             const Pose& X_WL_before, const NormalRule& normal, double softness_mm) {
  const Line line{volume, X_WL.position_mm, shaft_direction(X_WL)};
  ShaftContacts contacts;
  for (const Stretch& stretch : Stretches(line, span)) {
    add_contacts(line, stretch, X_WL_before, normal, softness_mm, contacts);
  }
  return contacts;
}

}  // namespace osteomill::line_proxy
