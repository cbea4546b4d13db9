#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/isovalue.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// How much of a scan a label has.
struct LabelSummary {
  Label label;
  std::size_t voxels = 0;
  double volume_mm3 = 0;
  /// The number of these voxels that are bone.
  std::size_t bone_voxels = 0;
};

/// All that `osteomill info` reports about a scan. Lengths in mm, in the patient's LPS frame.
struct ScanSummary {
  /// The scan, with all the warnings that are reported.
  Scan scan;
  double value_min = 0;
  double value_max = 0;
  double value_mean = 0;
  SuggestedIsovalue suggested_iso;
  /// The isovalue in use: the user's, or the suggested one.
  double isovalue = 0;
  /// Voxels whose density is greater than `isovalue`.
  std::size_t voxels_above_iso = 0;
  /// A summary of each label; empty if the scan has none.
  std::vector<LabelSummary> labels{};
  /// The volumes of the connected pieces of bone (piece_sizes), the largest first, mm^3.
  std::vector<double> pieces_mm3{};
};

/// Summarises a scan in one pass over its voxels. `suggested_iso` is reported as the suggested one
/// (`suggest_isovalue`).
ScanSummary summarise(Scan scan, SuggestedIsovalue suggested_iso, double isovalue);

/// Returns a summary of each of the bone's labels, if it has any. One pass over their voxels.
std::vector<LabelSummary> summarise_labels(const Volume& bone);

/// Returns the volumes of the bone's connected pieces, the largest first, mm^3.
std::vector<double> piece_volumes_mm3(const Volume& bone);

/// Returns a JSON object with the keys dims, spacing_mm, origin_mm, direction, value_min, value_max,
/// value_mean, suggested_iso, suggested_how, voxels_above_iso, warnings, boundaries, series if there are
/// several, voxels_without_density and labels if there are any, pieces (their count and the volumes of the
/// ten largest in mm^3), and a line feed at its end. Bytes of a
/// warning that are not UTF-8 are replaced.
std::string to_json(const ScanSummary& summary);

/// Returns the summary for people to read, a line for each fact.
std::string to_text(const ScanSummary& summary);

}  // namespace osteomill
