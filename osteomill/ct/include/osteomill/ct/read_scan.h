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

/// The name and the colour that a file gives a label (Scan::labels).
struct LabelName {
  int value = 0;
  std::string name;
  std::optional<std::array<std::uint8_t, 3>> colour{};
};

/// A scan as `read_scan` reads it.
struct Scan {
  DensityGrid grid;
  /// The file or folder as the user named it.
  std::string name;
  /// "DICOM", "NRRD", "MetaImage", "NIfTI", "PNG" or "TIFF".
  std::string format;
  /// One sentence each; what a user should know but what does not forbid milling.
  std::vector<std::string> warnings;
  /// True if the file says so, as DICOM does of CT.
  bool in_hounsfield_units = false;
  /// If there are several DICOM series, or volumes in one, a line on each in the order of their numbers:
  /// modality, description, what tells it from others of its series, size, spacing, one of its files, UID.
  std::vector<std::string> series = {};
  /// True if the file says that its values are labels, by its name (.seg.nrrd) or in its header.
  bool is_labels = false;
  /// Names of the labels, if the file itself has them (a DICOM segmentation).
  std::vector<LabelName> labels = {};
};

/// One of several DICOM series, or of the volumes in one, as a user chooses it.
struct SeriesSummary {
  /// The text that `ReadOptions::series` takes for it: 3, or 3.1 for one of several volumes in a series.
  std::string number;
  std::string modality;
  std::string description;
  /// The text that tells it from other volumes of its series; empty if it is all of one.
  std::string told_by;
  std::size_t slices = 0;
  /// Pixels of a slice.
  int columns = 0;
  int rows = 0;
  /// The distance from slice to slice, mm; nothing if the slices are no volume.
  std::optional<double> thickness_mm;
};

/// The choice of what to read, and of how much of the machine that may take.
struct ReadOptions {
  /// The DICOM series to read if there are several: its number (from 1; 3.1 for one of several volumes in a
  /// series), its UID or the beginning of that. If empty, the largest CT is read, with a warning.
  std::string series;
  /// The most memory that the densities may take, and the most that is unpacked of an archive. By default,
  /// the memory that the program may take.
  std::uint64_t max_memory_bytes = allowed_memory_bytes();
  /// The distances of voxels along columns, rows and slices, for pictures, which do not say them.
  std::optional<Vec3> spacing_mm = std::nullopt;
  /// Is called before any pixel is read if there are several series, none is named in `series`, and the
  /// path is not a file of one. Returns the number of the one to read. What it throws ends the reading.
  std::function<std::string(const std::vector<SeriesSummary>&)> choose_series = {};
};

/// Returns whether a file may be a scan: by its name (volume files, .zip, .dcm, .ima, DICOMDIR), or, if its
/// name has no ending in letters, because it begins as DICOM does. Pictures, which need a spacing, are not
/// among them. Reads at most 132 bytes.
bool may_be_scan(const std::filesystem::path& file);

/// Reads a DICOM series (a folder and the folders in it, files in any order; a DICOMDIR; one of its files,
/// with the rest of its series beside it; an Enhanced multi-frame file), NRRD, MetaImage, NIfTI, or pictures
/// (a folder of PNG or TIFF, a TIFF file of several pages), or a zip archive or folder of any of these. W is
/// the patient's LPS frame in mm (NIfTI's RAS is turned into it); stored values are rescaled to what they
/// mean (RescaleSlope, RescaleIntercept). Throws InputError, naming the path and the reason, if it is not a
/// scan that can be placed in space without guessing. Voxels for which it has no density, padding and NaN,
/// are known to the grid (`DensityGrid::has_density`). Bounded memory: what the header asks for is held
/// against the file and the options before it is allocated. Names of patients, their dates and numbers are
/// never read.
Scan read_scan(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace osteomill
