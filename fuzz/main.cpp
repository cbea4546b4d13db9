// Runs the target named in OSTEOMILL_FUZZ under libFuzzer. If OSTEOMILL_FUZZ_SEEDS is set, instead writes
// every target's seeds to a subfolder of that folder with the target's name.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/ct/scan_summary.h"
#include "osteomill/volume/isovalue.h"

#include "fuzz/targets.h"

namespace osteomill::fuzzing {

namespace fs = std::filesystem;

const std::vector<Target>& targets() {
  static const std::vector<Target> all = [] {
    std::vector<Target> found = volume_targets();
    for (const auto& part : {dicom_targets(), run_targets(), study_file_targets()})
      found.insert(found.end(), part.begin(), part.end());
    return found;
  }();
  return all;
}

void read_as_info_does(const fs::path& path, bool are_pictures) {
  ReadOptions options{.series = "", .max_memory_bytes = 1 << 26};
  if (are_pictures) options.spacing_mm = Vec3(1, 1, 1);
  const Scan scan = read_scan(path, options);
  const SuggestedIsovalue suggested = suggest_isovalue(scan.grid, scan.in_hounsfield_units);
  isovalue_warnings(scan.grid, suggested.value);
  const ScanSummary summary = summarise(scan, suggested, suggested.value);
  to_json(summary);
  to_text(summary);
}

void write_bytes(const fs::path& file, Bytes bytes) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::string read_bytes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

namespace {

void write_seeds(const fs::path& folder) {
  for (const Target& target : targets()) {
    const TemporaryFolder work;
    fs::create_directories(folder / target.name);
    int number = 0;
    for (const std::string& seed : target.seeds(work.path())) {
      const fs::path file = folder / target.name / ("seed" + std::to_string(number++));
      std::ofstream(file, std::ios::binary) << seed;
      // A seed that is refused would reach little code.
      const TemporaryFolder alone;
      target.read({reinterpret_cast<const unsigned char*>(seed.data()), seed.size()}, alone.path());
    }
    std::puts(target.name);
  }
}

const Target& chosen_target() {
  const char* const name = std::getenv("OSTEOMILL_FUZZ");
  for (const Target& target : targets()) {
    if (name != nullptr && name == std::string(target.name)) return target;
  }
  std::fputs("OSTEOMILL_FUZZ has to name a target\n", stderr);
  std::exit(2);
}

}  // namespace
}  // namespace osteomill::fuzzing

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (const char* const folder = std::getenv("OSTEOMILL_FUZZ_SEEDS")) {
    try {
      osteomill::fuzzing::write_seeds(folder);
    } catch (const osteomill::InputError& fault) {
      std::fprintf(stderr, "a seed is refused: %s\n", fault.what());
      std::exit(1);
    }
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const osteomill::fuzzing::Target& target = osteomill::fuzzing::chosen_target();
  static const osteomill::TemporaryFolder folder;
  try {
    target.read({data, size}, folder.path());
  } catch (const osteomill::InputError& fault) {
    // Messages to the user must be one line.
    if (std::string(fault.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
