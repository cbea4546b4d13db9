#include "osteomill/ct/dicom_folder.h"

#include <algorithm>

#include <fmt/format.h>

#include "osteomill/ct/dicom_file.h"
#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// A study has some thousands.
constexpr std::size_t kMaxFiles = 1 << 16;

template <typename Iterator>
std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (Iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    if (files.size() > kMaxFiles) {
      throw InputError(folder.string(), fmt::format("holds over {} files; name a folder in it", kMaxFiles));
    }
  }
  if (error) throw InputError(folder.string(), "cannot be read: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

DicomImages images_of(const std::vector<fs::path>& files) {
  DicomImages images;
  for (const fs::path& file : files) {
    WorkProgress::done(images.headers.size() + images.other_files, files.size());
    std::optional<DicomHeader> header = read_dicom_header(file);
    if (header && (header->is_image() || header->lost)) {
      images.headers.push_back(std::move(*header));
    } else {
      ++images.other_files;
    }
  }
  return images;
}

// Names on a disc are in capitals, and become small letters on some systems.
std::optional<fs::path> file_named(const fs::path& folder, const fs::path& name) {
  std::error_code ignored;
  for (const std::string& spelling : {name.string(), lower(name.string())}) {
    if (fs::is_regular_file(folder / spelling, ignored)) return folder / spelling;
  }
  return std::nullopt;
}

}  // namespace

DicomImages images_in_folder(const fs::path& folder, bool nested) {
  return images_of(nested ? files_in<fs::recursive_directory_iterator>(folder)
                          : files_in<fs::directory_iterator>(folder));
}

DicomImages images_of_directory(const DicomHeader& dicomdir) {
  const std::string subject = dicomdir.file.string();
  std::vector<fs::path> files;
  for (const fs::path& name : dicomdir.listed_files) {
    const std::optional<fs::path> file = file_named(dicomdir.file.parent_path(), name);
    if (!file) throw InputError(subject, fmt::format("names {}, which is not there", name.string()));
    files.push_back(*file);
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return images_of(files);
}

}  // namespace osteomill
