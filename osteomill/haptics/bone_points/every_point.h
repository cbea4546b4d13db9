#pragma once

#include "osteomill/haptics/bone_points/bone_bricks.h"

namespace osteomill {

/// For tests. Calls `f(point, origin_G)` for every point of one kind (`bricks.fine()` or `bricks.coarse()`),
/// which lies at `origin_G` + its place in the grid's frame. Makes all bricks.
template <typename F>
void for_each_point(BoneBricks& bricks, const BrickPoints& kind, F&& f) {
  const auto& dims = bricks.lattice().brick_dims();
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        const std::uint32_t slot = bricks.slot_of({i, j, k});
        if (slot == BoneBricks::kNoPoints) continue;
        const Vec3 origin_G = bricks.lattice().brick_origin_G({i, j, k});
        kind.for_each_of(slot, [&](const ShellPoint& point) { f(point, origin_G); });
      }
    }
  }
}

/// Calls `f(point_W, area_mm2)` for every fine point.
template <typename F>
void for_each_point(BoneBricks& bricks, F&& f) {
  const SurfaceLattice& lattice = bricks.lattice();
  for_each_point(bricks, bricks.fine(), [&](const ShellPoint& point, const Vec3& origin_G) {
    f(Vec3(lattice.origin_W() + lattice.direction() * (origin_G + point.position_mm())),
      static_cast<double>(point.area_mm2));
  });
}

}  // namespace osteomill
