#include "app/bone_picture.h"

#include <cstdio>
#include <stdexcept>

#include <fmt/core.h>

#include "osteomill/image/png.h"
#include "osteomill/view/bone_picture.h"

namespace osteomill::app {

namespace {

std::optional<std::vector<unsigned char>> picture(const Volume& bone, double reference_density,
                                                  const Camera& camera) {
  try {
    return encode_png(bone_picture(bone, reference_density, camera));
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "osteomill: no pictures of the bone are recorded: {}\n", error.what());
    return std::nullopt;
  }
}

}  // namespace

EntryPictures::EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry)
    : reference_density_(reference_density),
      camera_(camera_above(before, entry.point_W, entry.direction_W, entry.lateral_W)),
      before_(picture(before, reference_density, camera_)) {}

std::optional<std::vector<unsigned char>> EntryPictures::of(const Volume& milled) const {
  if (!before_) return std::nullopt;
  return picture(milled, reference_density_, camera_);
}

}  // namespace osteomill::app
