#pragma once

#include <string>

#include "app/scan_options.h"
#include <CLI/App.hpp>

namespace osteomill::app {

/// The options of the commands that write a bone to a file, as it was scanned or as a recording left it.
struct MilledScanOptions {
  ScanOptions scan;
  std::string out;
  /// Empty: as scanned.
  std::string recording;
};

/// Adds SCAN, --out and --after to a command. `out_text` says what --out may be.
void add_milled_scan_options(CLI::App& command, MilledScanOptions& options, const std::string& out_text);

/// The bone, milled as the recording did where there is one. The isovalue is the one given, else
/// the recording's, else a suggested one. Throws InputError where the scan, the isovalue or the recording is
/// at fault.
LoadedBone load_milled_bone(const MilledScanOptions& options);

/// The same where no isovalue matters.
DensityGrid load_milled_densities(const MilledScanOptions& options);

}  // namespace osteomill::app
