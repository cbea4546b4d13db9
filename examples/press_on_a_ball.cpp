// The haptics library alone: pushes a tool into a ball of bone and prints the wrench of each of the four
// algorithms.

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include <osteomill/haptics/algorithms.h>

namespace {

// Returns a ball of bone of radius 8 mm around the origin of W, with an edge two voxels wide.
osteomill::Volume ball_of_bone() {
  osteomill::GridGeometry geometry;
  geometry.dims = {96, 96, 96};
  geometry.spacing_mm = osteomill::Vec3::Constant(0.25);
  geometry.origin_mm = osteomill::Vec3::Constant(-0.25 * 95 / 2);
  std::vector<float> densities;
  for (int k = 0; k < 96; ++k) {
    for (int j = 0; j < 96; ++j) {
      for (int i = 0; i < 96; ++i) {
        const double distance_mm = geometry.world_from_voxel(osteomill::VoxelIndex{i, j, k}).norm() - 8.0;
        densities.push_back(static_cast<float>(1000 * std::clamp(0.5 - distance_mm / 0.5, 0.0, 1.0)));
      }
    }
  }
  return osteomill::Volume(osteomill::DensityGrid(geometry, std::move(densities)), 500.0);
}

}  // namespace

int main() {
  const osteomill::Volume bone = ball_of_bone();
  for (const osteomill::AlgorithmDescription& description : osteomill::all_algorithms()) {
    const auto algorithm = osteomill::make_algorithm(description, {});
    algorithm->prepare({&bone, osteomill::MillingTool{}});
    osteomill::HapticStep step;
    for (double height_mm = 10.5; height_mm > 7.9; height_mm -= 0.01) {
      step = algorithm->step({{0, 0, height_mm}, osteomill::Quat::Identity()}, 1e-3);
    }
    const osteomill::Vec3& force_N = step.wrench.force_N;
    std::printf("%-14s force %6.3f %6.3f %6.3f N, %d contacts\n", description.id.name.c_str(), force_N.x(),
                force_N.y(), force_N.z(), step.contacts);
    if (!(force_N.z() > 0)) return 1;
  }
  return 0;
}
