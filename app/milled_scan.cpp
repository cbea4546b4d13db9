#include "app/milled_scan.h"

#include <utility>

#include "app/positive_number.h"
#include "app/progress.h"

#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"

namespace osteomill::app {

void add_milled_scan_options(CLI::App& command, MilledScanOptions& options, const std::string& out_text) {
  add_scan_source(command, options.scan);
  command.add_option("--out", options.out, "The file to write, " + out_text)->required()->type_name("FILE");
  command
      .add_option("--after", options.recording,
                  "A recording (HDF5) made with this scan: the bone as milled at its end")
      ->type_name("FILE");
}

LoadedBone load_milled_bone(const MilledScanOptions& options) {
  if (options.recording.empty()) return load_bone(options.scan);
  const Recording recording = read_with_what_came_before(options.recording);
  ScanOptions scan = options.scan;
  if (!scan.isovalue) scan.isovalue = recording.description.isovalue;
  scan.made_into = recording.description.scan_hash;
  LoadedBone bone = read_bone(scan);
  repeat_milling(bone.volume, recording);
  for (const std::string& warning : bone.warnings) warn(warning);
  return bone;
}

DensityGrid load_milled_densities(const MilledScanOptions& options) {
  if (!options.recording.empty()) return load_milled_bone(options).volume.grid();
  Scan scan = open_scan(options.scan);
  for (const std::string& warning : scan.warnings) warn(scan.name + ": " + warning);
  return std::move(scan.grid);
}

}  // namespace osteomill::app
