#include "osteomill/experiment/bone_picture.h"

#include <algorithm>

#include "osteomill/surface/isosurface_picture.h"
#include "osteomill/surface/png.h"

namespace osteomill {

namespace {

constexpr double kWidestWhole_mm = 45.0;
constexpr double kAroundEntry_mm = 24.0;

}  // namespace

std::vector<unsigned char> picture_of_entry(const Volume& volume, const MillingEntry& entry) {
  // Steep enough to look into a hole of its own width.
  const Vec3 sideways = entry.direction_W.cross(entry.lateral_W);
  const Vec3 direction = 0.8 * entry.direction_W + 0.5 * sideways + 0.25 * entry.lateral_W;
  PictureView view = view_of_bone(volume, direction, -entry.direction_W);
  if (view.width_mm > kWidestWhole_mm) {
    view.centre_W = entry.point_W;
    view.width_mm = kAroundEntry_mm;
  }
  view.scale_bar = true;
  return encode_png(isosurface_picture(volume, view));
}

}  // namespace osteomill
