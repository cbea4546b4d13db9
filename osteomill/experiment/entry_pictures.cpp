#include "osteomill/experiment/entry_pictures.h"

#include <stdexcept>

#include <fmt/core.h>

#include "osteomill/image/image.h"
#include "osteomill/view/bone_picture.h"

namespace osteomill {

namespace {

std::optional<std::vector<unsigned char>> picture(const Volume& bone, double reference_density,
                                                  const Camera& camera, bool of_patient,
                                                  const RunEvents& events) {
  try {
    return encode_png(bone_picture(bone, reference_density, camera, {1120, 1120}, of_patient));
  } catch (const std::runtime_error& error) {
    events.warn(fmt::format("no pictures of the bone are recorded: {}", error.what()));
    return std::nullopt;
  }
}

}  // namespace

EntryPictures::EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry,
                             const RunEvents& events, bool of_patient)
    : reference_density_(reference_density),
      of_patient_(of_patient),
      camera_(camera_above(before, entry.point_W, entry.direction_W, entry.lateral_W)),
      before_(picture(before, reference_density, camera_, of_patient, events)) {}

std::optional<std::vector<unsigned char>> EntryPictures::of(const Volume& milled,
                                                            const RunEvents& events) const {
  if (!before_) return std::nullopt;
  return picture(milled, reference_density_, camera_, of_patient_, events);
}

}  // namespace osteomill
