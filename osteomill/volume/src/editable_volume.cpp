#include "osteomill/volume/editable_volume.h"

#include <array>
#include <cstring>
#include <utility>

namespace osteomill {

VoxelBox EditableVolume::swap(DensityBlock& block) {
  const VoxelBox inside = block.voxels_in(bone_.geometry());
  VoxelBox changed;
  VoxelBox risen;
  std::array<int, DensityBlock::kVoxels> columns;
  std::array<float, DensityBlock::kVoxels> densities;
  for (int k = inside.first.k; k <= inside.last.k; ++k) {
    for (int j = inside.first.j; j <= inside.last.j; ++j) {
      float* kept = &block.densities[block.index_of({inside.first.i, j, k})];
      const float* before = bone_.grid().address_of({inside.first.i, j, k});
      const auto length = static_cast<std::size_t>(inside.last.i - inside.first.i + 1);
      if (std::memcmp(kept, before, length * sizeof(float)) == 0) continue;
      std::size_t count = 0;
      for (int i = inside.first.i; i <= inside.last.i; ++i, ++kept) {
        const float was = bone_.grid()[{i, j, k}];
        if (was == *kept) continue;
        changed.include({i, j, k});
        if (*kept > was) risen.include({i, j, k});
        columns[count] = i;
        densities[count++] = *kept;
        bone_.set({i, j, k}, std::exchange(*kept, was));
      }
      bone_.ranges_.lower_row(j, k, columns.data(), densities.data(), count);
    }
  }
  bone_.ranges_.refresh(bone_.grid(), risen);
  return changed;
}

}  // namespace osteomill
