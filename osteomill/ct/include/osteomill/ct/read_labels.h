#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Names the files that the labels of a scan come from.
struct LabelFiles {
  /// NRRD, NIfTI or MetaImage; a voxel's value is its label, 0 is none. Or a DICOM segmentation, in a zip
  /// archive or folder too.
  std::filesystem::path map;
  /// A colour table of 3D Slicer's (.ctbl or .txt): a line a label, "value name red green blue alpha",
  /// colours from 0 to 255; or a label description file of ITK-SNAP's. Lines that begin with # and empty ones
  /// are passed over. Takes precedence over the names and colours that the map has itself (a .seg.nrrd, an
  /// extension of NIfTI); may be empty.
  std::filesystem::path table;
  /// Labels that no burr may touch, by value or by name (case does not matter).
  std::vector<std::string> no_go;
};

/// Returns whether files of such a name are label maps on their own, as `read_labels` reads them.
bool is_label_file(const std::filesystem::path& path);

/// A label map as read, and what a user should know about it.
struct LabelsRead {
  std::shared_ptr<const LabelMap> map;
  /// One sentence each, naming the file.
  std::vector<std::string> warnings;
};

/// Makes the label map of a scan that is one itself and says what its labels are called (`Scan::labels`),
/// with the table and the no-go labels of `files`. Throws InputError as `read_labels` does.
LabelsRead labels_in(const Scan& scan, const LabelFiles& files);

/// Reads a label map and puts it on the scan's grid, whatever its own is, by the nearest voxel. Labels
/// without a name are called "label 3", those without a colour get one that differs from their neighbours'.
/// Throws InputError, naming the file, if it cannot be read, its values are no labels (not whole, beyond a
/// million, more than LabelMap::kMaxLabels), it labels nothing, or nothing of the scan; and if a no-go label
/// is not in it, or its voxels take more memory than allowed.
LabelsRead read_labels(const LabelFiles& files, const GridGeometry& scan,
                       std::uint64_t max_memory_bytes = allowed_memory_bytes());

}  // namespace osteomill
