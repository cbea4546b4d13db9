#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/isovalue.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Extent of a label in a scan.
struct LabelSummary {
  Label label;
  std::size_t voxels = 0;
  double volume_mm3 = 0;
  /// Number of these voxels that are bone.
  std::size_t bone_voxels = 0;
};

/// Everything that `osteomill info` reports about a scan. Lengths in mm, in the patient's LPS frame.
struct ScanSummary {
  /// Scan, with all warnings to report.
  Scan scan;
  double value_min = 0;
  double value_max = 0;
  double value_mean = 0;
  SuggestedIsovalue suggested_iso;
  /// Isovalue in use: the user's or the suggested one.
  double isovalue = 0;
  /// Number of voxels whose density is above `isovalue`.
  std::size_t voxels_above_iso = 0;
  /// Summary of each label; empty if the scan has none.
  std::vector<LabelSummary> labels{};
  /// Volumes of the connected pieces of bone (piece_sizes), largest first, mm^3.
  std::vector<double> pieces_mm3{};
};

/// Summarises a scan in one pass over its voxels. `suggested_iso` is the result of `suggest_isovalue`. Leaves
/// labels and pieces empty.
ScanSummary summarise(Scan scan, SuggestedIsovalue suggested_iso, double isovalue);

/// Returns a summary of each of the bone's labels. One pass over the labelled box.
std::vector<LabelSummary> summarise_labels(const Volume& bone);

/// Returns the volumes of the bone's connected pieces, largest first, mm^3.
std::vector<double> piece_volumes_mm3(const Volume& bone);

/// Returns a JSON object and a line feed. Its keys are dims, spacing_mm, origin_mm, direction, value_min,
/// value_max, value_mean, suggested_iso, suggested_how, voxels_above_iso, warnings and boundaries; and,
/// unless empty, series, voxels_without_density, pieces (count, and the volumes of the ten largest in mm^3)
/// and labels. Replaces invalid UTF-8 in texts.
std::string to_json(const ScanSummary& summary);

/// Returns the summary as readable text, one line per fact.
std::string to_text(const ScanSummary& summary);

}  // namespace osteomill
