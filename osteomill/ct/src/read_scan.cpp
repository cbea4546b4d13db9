#include "osteomill/ct/read_scan.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <minizip/unzip.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/base/work_progress.h"

#include "dicom_file.h"
#include "header_text.h"
#include "picture_stack.h"
#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxFiles = 1 << 16;

struct Close {
  void operator()(void* archive) const { unzClose(archive); }
};

class ZipReader {
 public:
  ZipReader(const fs::path& path, std::uint64_t max_bytes)
      : path_(path), left_bytes_(max_bytes), max_bytes_(max_bytes), archive_(unzOpen64(path.c_str())) {
    if (archive_ == nullptr) throw damaged();
  }

  void unpack_into(const fs::path& folder);

 private:
  InputError fault(const std::string& reason) const { return {path_.string(), reason}; }
  InputError damaged() const { return fault("is a damaged zip archive, or packed by an unknown method"); }
  fs::path name_here(unz_file_info64& info) const;
  void unpack_here(const fs::path& file);

  fs::path path_;
  std::uint64_t left_bytes_;
  std::uint64_t max_bytes_;
  std::unique_ptr<std::remove_pointer_t<unzFile>, Close> archive_;
  std::vector<char> block_ = std::vector<char>(1 << 18);
};

// Returns the current file's name. Some archives use backslashes as separators.
fs::path ZipReader::name_here(unz_file_info64& info) const {
  std::string name(4096, '\0');
  if (unzGetCurrentFileInfo64(archive_.get(), &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) !=
      UNZ_OK)
    throw damaged();
  name.resize(std::min<std::size_t>(name.find('\0'), info.size_filename));
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path relative(name);
  if (relative.is_absolute() || std::find(relative.begin(), relative.end(), "..") != relative.end())
    throw fault("holds a file name that leads out of the archive");
  return relative;
}

void ZipReader::unpack_here(const fs::path& file) {
  fs::create_directories(file.parent_path());
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  if (unzOpenCurrentFile(archive_.get()) != UNZ_OK) throw damaged();
  int count = 0;
  while ((count = unzReadCurrentFile(archive_.get(), block_.data(), static_cast<unsigned>(block_.size()))) >
         0) {
    if (static_cast<std::uint64_t>(count) > left_bytes_) {
      throw fault(fmt::format("unpacks to more than the limit of {:.3g} GB (--max-memory)",
                              static_cast<double>(max_bytes_) * 1e-9));
    }
    left_bytes_ -= static_cast<std::uint64_t>(count);
    out.write(block_.data(), count);
    WorkProgress::done(0);
  }
  // unzCloseCurrentFile() verifies the checksum.
  if (count < 0 || unzCloseCurrentFile(archive_.get()) != UNZ_OK) throw damaged();
  out.close();
  if (!out) throw fault(with_reason(fmt::format("cannot be unpacked to {}", file.parent_path().string())));
}

void ZipReader::unpack_into(const fs::path& folder) {
  std::uint64_t files = 0;
  for (int state = unzGoToFirstFile(archive_.get()); state != UNZ_END_OF_LIST_OF_FILE;
       state = unzGoToNextFile(archive_.get())) {
    if (state != UNZ_OK) throw damaged();
    if (++files > kMaxFiles) throw fault(fmt::format("holds over {} files", kMaxFiles));
    unz_file_info64 info{};
    const fs::path name = name_here(info);
    if ((info.flag & 1) != 0) throw fault("is encrypted");
    if (name.has_filename()) unpack_here(folder / name);
  }
}

// Returns whether a file starts with the signature of zip archives.
bool is_zip(const fs::path& file) {
  std::string head(4, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), 4);
  return head == "PK\3\4";
}

// Unpacks a zip archive into `folder`, keeping names. Throws InputError, naming the archive, if it is damaged
// or encrypted, if a name leads out of the folder, or if its actual unpacked size exceeds `max_bytes`.
void unpack_zip(const fs::path& archive, const fs::path& folder, std::uint64_t max_bytes) {
  register_input(archive);
  try {
    ZipReader(archive, max_bytes).unpack_into(folder);
  } catch (const fs::filesystem_error& error) {
    throw InputError(archive.string(), "cannot be unpacked: " + error.code().message());
  }
}

// Returns the first names of files below a folder, in alphabetical order.
std::string names_in(const fs::path& folder, std::vector<fs::path> files) {
  constexpr std::size_t kMaxNames = 5;
  std::ranges::sort(files);
  std::string names;
  for (std::size_t n = 0; n < std::min(kMaxNames, files.size()); ++n)
    names += (n > 0 ? ", " : "") + files[n].lexically_relative(folder).string();
  return names + (files.size() > kMaxNames ? ", ..." : "");
}

// Reads a folder: its DICOM files, or else its only volume file, or else its pictures.
Scan read_folder(const fs::path& folder, const ReadOptions& options) {
  if (std::optional<Scan> scan = read_dicom(folder, options)) return std::move(*scan);
  std::vector<fs::path> volumes, pictures;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (entry.is_regular_file() && !hidden && volume_format_of(entry.path()) != nullptr &&
        !header_of_voxels(entry.path()))
      volumes.push_back(entry.path());
    if (entry.is_regular_file() && !hidden && is_picture(entry.path())) pictures.push_back(entry.path());
  }
  if (volumes.empty() && !pictures.empty()) return read_pictures(folder, std::move(pictures), options);
  if (volumes.empty()) {
    throw InputError(folder.string(),
                     "holds no scan: no DICOM slices and no NRRD, MetaImage, NIfTI, PNG or TIFF files");
  }
  if (volumes.size() > 1) {
    const std::size_t count = volumes.size();
    throw InputError(folder.string(), fmt::format("holds {} scans; choose one of them: {}", count,
                                                  names_in(folder, std::move(volumes))));
  }
  return read_volume_file(volumes.front(), *volume_format_of(volumes.front()), options);
}

std::string with_name(std::string text, const std::string& unpacked, const std::string& archive) {
  for (std::size_t at = 0; (at = text.find(unpacked, at)) != std::string::npos; at += archive.size())
    text.replace(at, unpacked.size(), archive);
  return text;
}

// Reads an archive. In messages, replaces the temporary folder by the archive.
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
  if (is_picture(path)) return read_pictures(path, {path}, options);
  if (is_zip(path)) return read_zip(path, options);
  if (std::optional<Scan> scan = read_dicom(path, options)) return std::move(*scan);
  throw InputError(
      path.string(),
      "is not a scan: not DICOM, not a zip archive, and not NRRD, MetaImage, NIfTI, PNG or TIFF by its name");
}

bool begins_as_dicom(const fs::path& file) {
  std::string head(132, '\0');
  std::ifstream(file, std::ios::binary).read(head.data(), 132);
  return head.ends_with("DICM");
}

}  // namespace

bool may_be_scan(const fs::path& file) {
  const std::string name = lower(file.filename().string());
  for (const char* const ending : {".zip", ".dcm", ".ima"})
    if (name.ends_with(ending)) return true;
  if (name == "dicomdir") return true;
  if (volume_format_of(file) != nullptr) return !header_of_voxels(file);
  // Many programs name slices by UID or number, without an extension.
  const std::string ending = file.extension().string();
  const bool has_letters =
      std::any_of(ending.begin(), ending.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  return !has_letters && begins_as_dicom(file);
}

Scan read_scan(const fs::path& path, const ReadOptions& options) {
  try {
    Scan scan = read_any(path, options);
    scan.name = path.string();
    if (options.spacing_mm && scan.format != "PNG" && scan.format != "TIFF")
      throw InputError(
          scan.name, fmt::format("is {}, which has its own voxel spacing; leave out --spacing", scan.format));
    return scan;
  } catch (const std::bad_alloc&) {
    throw InputError(path.string(), "does not fit into memory");
  } catch (const fs::filesystem_error& error) {
    throw InputError(path.string(), "cannot be read: " + error.code().message());
  }
}

}  // namespace osteomill
