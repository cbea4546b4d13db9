#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// Files with the labels of a scan.
struct LabelFiles {
  /// Label map: NRRD, NIfTI or MetaImage, in which a voxel's value is its label and 0 means none; or a DICOM
  /// segmentation, also in a zip archive or folder.
  std::filesystem::path map;
  /// Colour table of 3D Slicer (.ctbl or .txt), with one line per label, "value name red green blue alpha",
  /// colours from 0 to 255; or label description file of ITK-SNAP. Ignores empty lines and lines that start
  /// with #. Overrides names and colours in the map itself (.seg.nrrd, NIfTI extensions). May be empty.
  std::filesystem::path table;
  /// Labels that no burr may touch, by value or by name (case-insensitive).
  std::vector<std::string> no_go;
};

/// Returns whether the file's name is that of a volume file, which `read_labels` reads as a label map.
bool is_label_file(const std::filesystem::path& path);

/// Label map as read, and warnings for the user.
struct LabelsRead {
  std::shared_ptr<const LabelMap> map;
  /// One sentence each, naming the file.
  std::vector<std::string> warnings;
};

/// Makes a label map from a scan that is itself one and names its labels (`Scan::labels`), with the table and
/// the no-go labels of `files`. Throws InputError as `read_labels` does.
LabelsRead labels_in(const Scan& scan, const LabelFiles& files);

/// Reads a label map and resamples it to the scan's grid by nearest neighbour. A label without a name is
/// called "label" and its value; one without a colour gets one unlike those of adjacent values. Throws
/// InputError, naming the file, if it cannot be read, its values are not labels (not whole, beyond a million,
/// more than LabelMap::kMaxLabels), it labels no voxel or none of the scan, it lacks a no-go label, or its
/// voxels need more than `max_memory_bytes`.
LabelsRead read_labels(const LabelFiles& files, const GridGeometry& scan,
                       std::uint64_t max_memory_bytes = allowed_memory_bytes());

}  // namespace osteomill
