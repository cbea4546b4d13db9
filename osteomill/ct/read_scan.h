#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// A scan as read.
struct Scan {
  DensityGrid grid;
  /// The file or folder as the user named it.
  std::string name;
  /// "DICOM", "NRRD", "MetaImage" or "NIfTI".
  std::string format;
  /// One sentence each; what a user should know but what does not forbid milling.
  std::vector<std::string> warnings;
  /// Where the file says so, as DICOM does of CT.
  bool in_hounsfield_units = false;
};

/// Reads a DICOM series (a folder, its files in any order, or one multi-slice file), NRRD, MetaImage or
/// NIfTI. W is the patient's LPS frame in mm (NIfTI's RAS is turned into it); stored values are rescaled to
/// what they mean (RescaleSlope, RescaleIntercept). Throws InputError, naming the path and the reason, where
/// it is not a scan that can be placed in space without guessing. Bounded memory: sizes are checked against
/// the file before anything is allocated.
Scan read_scan(const std::filesystem::path& path);

}  // namespace osteomill
