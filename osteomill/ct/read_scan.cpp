#include "osteomill/ct/read_scan.h"

#include <new>

#include <fmt/format.h>
#include <unistd.h>

#include "osteomill/ct/dicom_scan.h"
#include "osteomill/ct/volume_file.h"
#include "osteomill/ct/zip_archive.h"
#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Of a folder without DICOM: its only volume file.
Scan read_folder(const fs::path& folder, const ReadOptions& options) {
  if (std::optional<Scan> scan = read_dicom(folder, options)) return std::move(*scan);
  std::vector<fs::path> volumes;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (entry.is_regular_file() && !hidden && volume_format_of(entry.path()) != nullptr)
      volumes.push_back(entry.path());
  }
  if (volumes.empty()) throw InputError(folder.string(), "holds no DICOM slices");
  if (volumes.size() > 1) {
    throw InputError(folder.string(), fmt::format("holds {} scans; name one of them", volumes.size()));
  }
  return read_volume_file(volumes.front(), *volume_format_of(volumes.front()), options);
}

std::string with_name(std::string text, const std::string& unpacked, const std::string& archive) {
  for (std::size_t at = 0; (at = text.find(unpacked, at)) != std::string::npos; at += archive.size())
    text.replace(at, unpacked.size(), archive);
  return text;
}

// What is told of it names the archive, not where it was unpacked.
Scan read_zip(const fs::path& archive, const ReadOptions& options) {
  const TemporaryFolder unpacked;
  try {
    unpack_zip(archive, unpacked.path(), options.max_memory_bytes);
    Scan scan = read_folder(unpacked.path(), options);
    for (std::string& warning : scan.warnings)
      warning = with_name(std::move(warning), unpacked.path().string(), archive.string());
    return scan;
  } catch (const InputError& fault) {
    const std::string line = with_name(fault.what(), unpacked.path().string(), archive.string());
    const std::size_t colon = line.find(": ");
    throw InputError(line.substr(0, colon), line.substr(colon + 2));
  }
}

Scan read_any(const fs::path& path, const ReadOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path.string(), "no such file or folder");
  if (fs::is_directory(status)) return read_folder(path, options);
  if (!fs::is_regular_file(status)) throw InputError(path.string(), "is neither a file nor a folder");
  if (fs::file_size(path, error) == 0) throw InputError(path.string(), "is empty");
  if (const VolumeFormat* format = volume_format_of(path)) return read_volume_file(path, *format, options);
  if (is_zip(path)) return read_zip(path, options);
  if (std::optional<Scan> scan = read_dicom(path, options)) return std::move(*scan);
  throw InputError(
      path.string(),
      "is not a scan: neither DICOM nor a zip archive, nor NRRD, MetaImage or NIfTI by its name");
}

}  // namespace

std::uint64_t memory_of_machine() {
  return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

Scan read_scan(const fs::path& path, const ReadOptions& options) {
  try {
    Scan scan = read_any(path, options);
    scan.name = path.string();
    return scan;
  } catch (const std::bad_alloc&) {
    throw InputError(path.string(), "does not fit into memory");
  } catch (const fs::filesystem_error& error) {
    throw InputError(path.string(), "cannot be read: " + error.code().message());
  }
}

}  // namespace osteomill
