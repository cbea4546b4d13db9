#include "osteomill/ct/volume_file.h"

#include <fmt/format.h>

#include "osteomill/ct/plausible_scan.h"
#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

Scan read_behind(VolumeHeader header, const std::string& subject, const char* format,
                 const ReadOptions& options) {
  if (!options.series.empty()) {
    throw InputError(subject, fmt::format("is {}, which has no series to choose from", format));
  }
  std::vector<float> densities;
  {
    const WorkProgress::Part reading(0.85);
    densities = read_voxels(subject, header.voxels, header.geometry.voxel_count(), options.max_memory_bytes,
                            header.warnings);
  }
  const WorkProgress::Part checking(1);
  check_finite(subject, densities);
  return {DensityGrid(header.geometry, std::move(densities)), subject, format, std::move(header.warnings)};
}

}  // namespace

Scan read_volume_file(const fs::path& path, VolumeFormat format, const ReadOptions& options) {
  switch (format) {
    case VolumeFormat::nrrd:
      return read_behind(read_nrrd_header(path), path.string(), "NRRD", options);
    case VolumeFormat::metaimage:
      return read_behind(read_metaimage_header(path), path.string(), "MetaImage", options);
    default:
      return read_behind(read_nifti_header(path), path.string(), "NIfTI", options);
  }
}

}  // namespace osteomill
