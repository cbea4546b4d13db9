#include "osteomill/ct/volume_file.h"

#include <array>

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
  check_densities(subject, densities);
  Scan scan{DensityGrid(header.geometry, std::move(densities)), subject, format, std::move(header.warnings)};
  scan.is_labels = header.is_labels || subject.find(".seg.") != std::string::npos;
  return scan;
}

}  // namespace

std::optional<VolumeFormat> volume_format_of(const fs::path& path) {
  const std::string name = lower(path.filename().string());
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return VolumeFormat::nrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return VolumeFormat::metaimage;
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return VolumeFormat::nifti;
  return std::nullopt;
}

VolumeHeader read_volume_header(const fs::path& path, VolumeFormat format) {
  switch (format) {
    case VolumeFormat::nrrd:
      return read_nrrd_header(path);
    case VolumeFormat::metaimage:
      return read_metaimage_header(path);
    default:
      return read_nifti_header(path);
  }
}

Scan read_volume_file(const fs::path& path, VolumeFormat format, const ReadOptions& options) {
  constexpr std::array kNames{"NRRD", "MetaImage", "NIfTI"};
  return read_behind(read_volume_header(path, format), path.string(),
                     kNames[static_cast<std::size_t>(format)], options);
}

}  // namespace osteomill
