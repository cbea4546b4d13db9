#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/base/machine.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Name and colour that a file gives a label (Scan::labels).
struct LabelName {
  int value = 0;
  std::string name;
  std::optional<std::array<std::uint8_t, 3>> colour{};
};

/// Scan as read by `read_scan`.
struct Scan {
  DensityGrid grid;
  /// File or folder as the user named it.
  std::string name;
  /// "DICOM", "NRRD", "MetaImage", "NIfTI", "PNG" or "TIFF".
  std::string format;
  /// Warnings for the user that do not prevent milling, one sentence each.
  std::vector<std::string> warnings;
  /// True if the file states it, as DICOM does for CT.
  bool in_hounsfield_units = false;
  /// If there are several DICOM series, or several volumes in one, a line for each in the order of their
  /// numbers: modality, description, distinguishing mark within its series, size, spacing, one of its files,
  /// UID.
  std::vector<std::string> series = {};
  /// True if the file's name (.seg.nrrd) or header states that its values are labels.
  bool is_labels = false;
  /// Names of the labels, if the file contains them (DICOM segmentation).
  std::vector<LabelName> labels = {};
};

/// Choice offered to the user: one of several DICOM series, or of several volumes in a series.
struct SeriesSummary {
  /// Value for `ReadOptions::series`: 3, or 3.1 for one of several volumes in a series.
  std::string number;
  std::string modality;
  std::string description;
  /// Marks that distinguish it from other volumes of its series; empty if it is a whole series.
  std::string distinguishing_marks;
  std::size_t slices = 0;
  /// Pixels per slice.
  int columns = 0;
  int rows = 0;
  /// Distance between slices, mm; nullopt if the slices do not form a volume.
  std::optional<double> thickness_mm;
};

/// Options for reading a scan.
struct ReadOptions {
  /// DICOM series to read if there are several: its number (from 1; 3.1 for one of several volumes in a
  /// series), its UID or a prefix of that. If empty, reads the largest CT and adds a warning.
  std::string series;
  /// Limit on the memory of the densities, and on the unpacked size of an archive. By default, the memory
  /// available to the program.
  std::uint64_t max_memory_bytes = allowed_memory_bytes();
  /// Voxel spacing along i, j and k. Required for pictures, which do not contain it, and refused for all
  /// other formats.
  std::optional<Vec3> spacing_mm = std::nullopt;
  /// Called before any pixel is read if there are several series, `series` is empty and the path is not a
  /// slice file. Returns the number of the series to read. Its exceptions are passed on.
  std::function<std::string(const std::vector<SeriesSummary>&)> choose_series = {};
};

/// Returns whether a file may be a scan, by its name (volume files, .zip, .dcm, .ima, DICOMDIR) or, if its
/// extension has no letters, by the DICOM prefix. Returns false for pictures, which need a spacing. Reads at
/// most 132 bytes.
bool may_be_scan(const std::filesystem::path& file);

/// Reads a DICOM series (a folder with subfolders, files in any order; a DICOMDIR; one file, with the rest of
/// its series in the same folder; an Enhanced multi-frame file), NRRD, MetaImage, NIfTI, pictures (a folder
/// of PNG or TIFF, a multi-page TIFF file), or a zip archive or folder of any of these. W is the patient's
/// LPS frame in mm (NIfTI's RAS is converted); stored values are rescaled (RescaleSlope, RescaleIntercept).
/// Throws InputError, naming the path and the reason, if it is not a scan or its position in space is
/// ambiguous. Padding and NaN become voxels without density (`DensityGrid::has_density`). Memory is bounded:
/// sizes in the header are checked against the file and the options before allocation. Never reads patients'
/// names, dates or identifiers.
Scan read_scan(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace osteomill
