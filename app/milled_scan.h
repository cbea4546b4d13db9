#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/scan_options.h"
#include <CLI/App.hpp>

namespace osteomill::app {

/// The options of the commands that write a bone to a file, as it was scanned or as a recording left it.
struct MilledScanOptions {
  /// [SCAN] OUT as given.
  std::vector<std::string> scan_and_out;
  /// Empty: as scanned.
  std::string recording;

  /// Empty: the built-in tooth.
  std::string scan() const { return scan_and_out.size() > 1 ? scan_and_out.front() : std::string(); }
  const std::string& out() const { return scan_and_out.back(); }
};

/// Adds [SCAN] OUT and --after to a command. `out_text` says what OUT may be.
void add_milled_scan_options(CLI::App& command, MilledScanOptions& options, const std::string& out_text);

/// The bone, milled as the recording did where there is one. The isovalue is `isovalue`, else the
/// recording's, else a suggested one. Throws InputError where the scan, the isovalue or the recording is at
/// fault.
LoadedBone load_milled_bone(const MilledScanOptions& options, const std::optional<double>& isovalue);

/// The same where no isovalue matters.
DensityGrid load_milled_densities(const MilledScanOptions& options);

}  // namespace osteomill::app
