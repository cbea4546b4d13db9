#include "osteomill/study/entry_pictures.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/core.h>

#include "osteomill/visual/bone_picture.h"
#include "osteomill/visual/image.h"
#include "osteomill/volume/sampling.h"

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

double visible_fraction(const Volume& before, const Volume& milled, const Camera& camera) {
  constexpr std::array kBeside{VoxelIndex{-1, 0, 0}, VoxelIndex{1, 0, 0},  VoxelIndex{0, -1, 0},
                               VoxelIndex{0, 1, 0},  VoxelIndex{0, 0, -1}, VoxelIndex{0, 0, 1}};
  constexpr int kBrick = BlockRanges::kBrickVoxels;
  const GridGeometry& geometry = before.geometry();
  double seen = 0, all = 0;
  for_each(geometry.all_voxels().bricks(kBrick), [&](const VoxelIndex& brick) {
    if (before.ranges().at(brick).changes == milled.ranges().at(brick).changes) return;
    for_each(VoxelBox::of_brick(brick, kBrick).intersected(geometry.all_voxels()), [&](const VoxelIndex& v) {
      if (!before.is_bone(v) || milled.is_bone(v)) return;
      const bool at_surface = std::any_of(kBeside.begin(), kBeside.end(), [&](const VoxelIndex& by) {
        return milled.is_bone_in_grid({v.i + by.i, v.j + by.j, v.k + by.k});
      });
      if (!at_surface) return;
      all += 1;
      seen += first_crossing(milled, geometry.world_from_voxel(v), camera.eye_W()) ? 0 : 1;
    });
  });
  return all > 0 ? seen / all : 1;
}

EntryPictures::EntryPictures(const Volume& before, double reference_density, const MillingEntry& entry,
                             const RunEvents& events, bool of_patient)
    : bone_(before),
      entry_(entry),
      reference_density_(reference_density),
      of_patient_(of_patient),
      camera_(camera_above(before, entry.point_W, entry.direction_W, entry.lateral_W)),
      before_(picture(before, reference_density, camera_, of_patient, events)) {}

std::optional<std::vector<unsigned char>> EntryPictures::of(std::string_view name, const Volume& milled,
                                                            const RunEvents& events) const {
  if (!before_ || name == kPictureBefore) return before_;
  const bool along = name == kPictureAlong;
  if (along && visible_fraction(bone_, milled, camera_) >= 0.5) return std::nullopt;
  const Camera camera =
      along ? camera_along(bone_, entry_.point_W, entry_.direction_W, entry_.lateral_W) : camera_;
  return picture(milled, reference_density_, camera, of_patient_, events);
}

}  // namespace osteomill
