#include "app/milled_scan.h"

#include "osteomill/recording/read_recording.h"
#include "osteomill/recording/repeat_milling.h"

namespace osteomill::app {

void add_milled_scan_options(CLI::App& command, MilledScanOptions& options, const std::string& out_text) {
  command
      .add_option(
          "scan_and_out", options.scan_and_out,
          "The scan (DICOM folder or file, NRRD, MetaImage or NIfTI; without one, the built-in tooth), "
          "and the file to write, " +
              out_text)
      ->option_text("[SCAN] OUT")
      ->expected(1, 2)
      ->required();
  command.add_option("--iso", options.isovalue, "Isovalue: bone where the density is greater");
  command.add_option("--after", options.recording,
                     "A recording (HDF5) made with this scan: the bone as milled at its end");
}

LoadedBone load_milled_bone(const MilledScanOptions& options) {
  ScanOptions scan;
  if (options.scan_and_out.size() > 1) scan.scan = options.scan_and_out.front();
  scan.isovalue = options.isovalue;
  if (options.recording.empty()) return load_bone(scan);

  const Recording recording = read_recording(options.recording);
  if (!scan.isovalue) scan.isovalue = recording.description.isovalue;
  LoadedBone bone = load_bone(scan);
  repeat_milling(bone.volume, recording);
  return bone;
}

}  // namespace osteomill::app
