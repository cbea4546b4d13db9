#include "osteomill/view/annotations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace osteomill {

namespace {

constexpr double kMargin_px = 24;
constexpr double kTick_px = 5;
// Half of the longest text.
constexpr double kTextReach_px = 84;
constexpr double kAxis_px = 30;
constexpr double kLetter_px = 44;
constexpr double kMinAxis = 0.25;

// 1, 2 or 5 times a power of ten.
double round_length_mm(double max_mm) {
  const double power = std::pow(10.0, std::floor(std::log10(max_mm)));
  for (const double times : {5.0, 2.0}) {
    if (times * power <= max_mm) return times * power;
  }
  return power;
}

}  // namespace

Annotation scale_bar_annotation(const Camera& camera, const PixelSize& size) {
  const double pixel_mm = mm_per_pixel(camera, size, camera.distance_mm);
  const double length_mm = round_length_mm(0.25 * size.width * pixel_mm);
  const Eigen::Vector2d left(kMargin_px, size.height - kMargin_px);
  const Eigen::Vector2d right = left + Eigen::Vector2d(length_mm / pixel_mm, 0);
  const Eigen::Vector2d tick(0, kTick_px);
  std::array<char, 32> text{};
  // Where lengths change with their depth by more than a few hundredths.
  constexpr double kWide_rad = 0.1;
  const char* const where = camera.field_of_view_rad > kWide_rad ? " at the centre" : "";
  std::snprintf(text.data(), text.size(), "%g mm%s", length_mm, where);
  Eigen::Vector2d place = 0.5 * (left + right) - Eigen::Vector2d(0, 14);
  place.x() = std::max(place.x(), kTextReach_px);
  return {{{left, right}, {left - tick, left + tick}, {right - tick, right + tick}}, place, text.data()};
}

std::vector<Annotation> orientation_letters(const Camera& camera, const PixelSize& size) {
  const std::pair<const char*, Vec3> axes[] = {{"L", Vec3::UnitX()}, {"R", -Vec3::UnitX()},
                                               {"P", Vec3::UnitY()}, {"A", -Vec3::UnitY()},
                                               {"S", Vec3::UnitZ()}, {"I", -Vec3::UnitZ()}};
  const Eigen::Vector2d middle(size.width - kMargin_px - kLetter_px, size.height - kMargin_px - kLetter_px);
  std::vector<Annotation> letters;
  for (const auto& [name, axis_W] : axes) {
    const Eigen::Vector2d seen(axis_W.dot(camera.right_W()), -axis_W.dot(camera.up_W()));
    if (seen.norm() < kMinAxis) continue;
    letters.push_back({{{middle, middle + kAxis_px * seen}}, middle + kLetter_px * seen, name});
  }
  return letters;
}

}  // namespace osteomill
