// Time to build and update the shell, and its memory: bytes per voxel and per point, as counted by the
// allocator.

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "osteomill/milling/burr_mill.h"
#include "osteomill/volume/bone_densities.h"

#include "benchmarks/bones.h"
#include "benchmarks/percentiles.h"
#include "bone_points/bone_bricks.h"

namespace osteomill::benchmarks {

namespace {

double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

void build_shell(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  for ([[maybe_unused]] auto _ : state) {
    const double before = allocated_bytes();
    const BoneBricks bricks(volume, BoneBricks::kSpacing_mm);
    const double bytes = allocated_bytes() - before;
    state.counters["bytes_per_voxel"] = bytes / static_cast<double>(volume.geometry().voxel_count());
  }
}

// Measures the memory of a volume: its densities and their ranges.
void copy_volume(benchmark::State& state, Bone bone) {
  const Volume& volume = bone_volume(bone);
  for ([[maybe_unused]] auto _ : state) {
    const double before = allocated_bytes();
    const Volume copy = volume;
    state.counters["bytes_per_voxel"] =
        (allocated_bytes() - before) / static_cast<double>(copy.geometry().voxel_count());
  }
}

void make_mill(benchmark::State& state, Bone bone) {
  Volume volume = bone_volume(bone);
  for ([[maybe_unused]] auto _ : state) {
    const double before = allocated_bytes();
    const BurrMill mill(volume, 3.0, estimate_densities(volume), {});
    state.counters["bytes_per_voxel"] =
        (allocated_bytes() - before) / static_cast<double>(volume.geometry().voxel_count());
  }
}

const bool kAdded = [] {
  for (const Bone bone : {Bone::builtin, Bone::builtin_refined, Bone::real_tooth, Bone::real_tooth_refined}) {
    if (!is_available(bone)) continue;
    const auto register_one = [&](const char* what, auto function) {
      benchmark::RegisterBenchmark((std::string(what) + "/" + name_of(bone)).c_str(), function, bone)
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    };
    register_one("build_shell", build_shell);
    register_one("copy_volume", copy_volume);
    register_one("make_mill", make_mill);
  }
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
