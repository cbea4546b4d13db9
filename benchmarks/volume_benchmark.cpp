// Sampling densities and gradients at points near the surface, and computing a volume's derived data.

#include <array>

#include <benchmark/benchmark.h>

#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/sampling.h"

#include "benchmarks/bones.h"

namespace osteomill::benchmarks {

namespace {

// A fixed spiral through the tooth's crown.
std::vector<Vec3> sample_places(const Volume& volume) {
  const GridGeometry& geometry = volume.geometry();
  const Vec3 dims(geometry.dims[0], geometry.dims[1], geometry.dims[2]);
  std::vector<Vec3> places;
  for (int n = 0; n < 4096; ++n) {
    const double t = n / 4096.0, angle = 2.399963 * n;
    const Vec3 share(0.5 + 0.2 * t * std::cos(angle), 0.5 + 0.2 * t * std::sin(angle), 0.3 + 0.5 * t);
    places.push_back(geometry.world_from_voxel(dims.cwiseProduct(share).eval()));
  }
  return places;
}

void density(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  const std::vector<Vec3> places = sample_places(volume);
  std::size_t n = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(density_at(volume.grid(), places[n++ % places.size()]));
  }
}

void gradient(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  const std::vector<Vec3> places = sample_places(volume);
  std::size_t n = 0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(density_gradient(volume.grid(), places[n++ % places.size()]));
  }
}

void make_builtin_tooth(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(builtin_tooth(1.0));
}

void find_densities(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(estimate_densities(volume));
}

void make_ranges(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(BlockRanges(volume.grid()));
}

const bool kAdded = [] {
  for (const Bone bone : {Bone::builtin, Bone::builtin_refined}) {
    const std::string where = "/" + name_of(bone);
    benchmark::RegisterBenchmark(("density_at" + where).c_str(), density, bone);
    benchmark::RegisterBenchmark(("density_gradient" + where).c_str(), gradient, bone);
    benchmark::RegisterBenchmark(("estimate_densities" + where).c_str(), find_densities, bone)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("brick_ranges" + where).c_str(), make_ranges, bone)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("builtin_tooth/256", make_builtin_tooth)->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
