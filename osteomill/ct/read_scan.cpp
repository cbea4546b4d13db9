#include "osteomill/ct/read_scan.h"

#include <algorithm>
#include <cctype>
#include <new>

#include "osteomill/ct/dicom_series.h"
#include "osteomill/ct/volume_file.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::optional<VolumeFormat> format_by_name(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return VolumeFormat::nrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return VolumeFormat::metaimage;
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return VolumeFormat::nifti;
  return std::nullopt;
}

Scan read_any(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path.string(), "no such file or folder");
  if (fs::is_directory(status)) return read_dicom_folder(path);
  if (!fs::is_regular_file(status)) throw InputError(path.string(), "is neither a file nor a folder");
  if (fs::file_size(path, error) == 0) throw InputError(path.string(), "is empty");
  if (const auto format = format_by_name(path)) return read_volume_file(path, *format);
  if (std::optional<Scan> scan = read_dicom_file(path)) return std::move(*scan);
  throw InputError(path.string(), "is not a scan: neither DICOM nor NRRD, MetaImage or NIfTI by its name");
}

}  // namespace

Scan read_scan(const fs::path& path) {
  try {
    return read_any(path);
  } catch (const std::bad_alloc&) {
    throw InputError(path.string(), "does not fit into memory");
  }
}

}  // namespace osteomill
