#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/suggest_isovalue.h"
#include "osteomill/volume/volume.h"

namespace osteomill::app {

/// Which bone to work on.
struct ScanOptions {
  /// Empty: the built-in tooth.
  std::string scan;
  /// Not given: the built-in tooth's own, or one suggested from the scan's values.
  std::optional<double> isovalue;
};

/// Adds SCAN and --iso to a command.
void add_scan_options(CLI::App& command, ScanOptions& options);

/// The scan, or the built-in tooth; the scan's warnings are its own. Throws InputError as `read_scan` does.
Scan open_scan(const ScanOptions& options);

/// The isovalue that the user leaves us to choose for this scan.
SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan);

/// The isovalue in use: the user's, or else the suggested one.
SuggestedIsovalue chosen_isovalue(const ScanOptions& options, const Scan& scan);

/// The scan's warnings, one line each on standard error.
void print_warnings(const Scan& scan);

/// Throws InputError where the isovalue lies outside the scan's values, so that there is no bone, or nothing
/// but bone.
void require_isovalue_within(const Scan& scan, double isovalue);

/// A bone ready to be milled.
struct LoadedBone {
  Volume volume;
  /// The scan as the user named it, or "built-in tooth".
  std::string name;
  /// Where its isovalue came from: "given", or how it was suggested; half a sentence.
  std::string isovalue_from;
};

/// Reads the scan; its warnings, and an isovalue that had to be suggested, go to standard error as one line
/// each. Throws InputError where the scan or the isovalue is at fault.
LoadedBone load_bone(const ScanOptions& options);

}  // namespace osteomill::app
