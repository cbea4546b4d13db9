// Reading scans. The scans are not part of the project; without ../shared/data, this is skipped with a
// message.

#include <cstdio>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>

#include "osteomill/ct/read_scan.h"

namespace osteomill::benchmarks {

namespace {

void read(benchmark::State& state, const std::filesystem::path& path) {
  for ([[maybe_unused]] auto _ : state) {
    const Scan scan = read_scan(path);
    state.counters["voxels"] = static_cast<double>(scan.grid.geometry().voxel_count());
  }
}

const bool kAdded = [] {
  const std::filesystem::path data = OSTEOMILL_SHARED_DATA;
  for (const char* name : {"tooth_dicom/series", "tooth/tooth_103x94x161_u16.nrrd"}) {
    if (!std::filesystem::exists(data / name)) {
      std::fprintf(stderr, "read_scan/%s: skipped, the scan is not on this machine\n", name);
      continue;
    }
    benchmark::RegisterBenchmark(("read_scan/" + std::string(name)).c_str(), read, data / name)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace

}  // namespace osteomill::benchmarks
