// The distance of the burr from no-go structures, as computed in every tick: three nerves of voxels in a scan
// of the size of a temporal bone.

#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "osteomill/volume/structure_distance.h"

namespace osteomill::benchmarks {

namespace {

GridGeometry temporal_bone() {
  GridGeometry scan;
  scan.dims = {256, 256, 200};
  scan.spacing_mm = {0.25, 0.25, 0.25};
  return scan;
}

NoGoDistances nerves(const GridGeometry& scan) {
  NoGoDistances distances;
  for (const int beside : {-40, 0, 40}) {
    VoxelSet nerve(VoxelBox{{60, 60, 60}, {200, 200, 140}});
    for (int n = 0; n < 500; ++n) {
      const double t = n / 500.0;
      const VoxelIndex middle{70 + static_cast<int>(120 * t),
                              130 + beside + static_cast<int>(25 * std::sin(5 * t)),
                              70 + static_cast<int>(60 * t * t)};
      for_each(
          VoxelBox{{middle.i - 2, middle.j - 2, middle.k - 2}, {middle.i + 2, middle.j + 2, middle.k + 2}},
          [&](const VoxelIndex& v) { nerve.insert(v); });
    }
    distances.push_back({StructureDistance(nerve, scan)});
  }
  return distances;
}

void distance_of_a_tick(benchmark::State& state) {
  const GridGeometry scan = temporal_bone();
  const NoGoDistances distances = nerves(scan);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0.2, 0.8);
  std::vector<Vec3> poses_W;
  for (int n = 0; n < 10000; ++n)
    poses_W.push_back(
        scan.world_from_voxel(Vec3(256 * share(random), 256 * share(random), 200 * share(random))));
  std::size_t n = 0;
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(no_go_distance_mm(distances, poses_W[n++ % poses_W.size()], 1.5));
}
BENCHMARK(distance_of_a_tick)->Name("no_go/distance_of_a_tick")->Unit(benchmark::kMicrosecond);

}  // namespace

}  // namespace osteomill::benchmarks
