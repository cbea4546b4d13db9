#include "osteomill/ct/dicom_series.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "osteomill/ct/dicom_file.h"
#include "osteomill/ct/header_text.h"
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

DicomImages images_of(const std::vector<fs::path>& files, std::uint64_t max_bytes) {
  DicomImages images;
  for (const fs::path& file : files) {
    WorkProgress::done(images.headers.size() + images.other_files, files.size());
    std::optional<DicomHeader> header = read_dicom_header(file, max_bytes);
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

// As they would be read.
std::string size_and_spacing(const DicomSeries& series) {
  try {
    const GridGeometry grid = stack_slices("", series.planes()).geometry;
    return fmt::format("{} x {} x {}, {:.4g} x {:.4g} x {:.4g} mm", grid.dims[0], grid.dims[1], grid.dims[2],
                       grid.spacing_mm.x(), grid.spacing_mm.y(), grid.spacing_mm.z());
  } catch (const InputError&) {
    std::size_t slices = 0;
    for (const DicomHeader& header : series.headers) slices += header.slices.size();
    return fmt::format("{} slices, no volume", slices);
  }
}

std::optional<std::size_t> number_of(const std::string& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

DicomImages images_in_folder(const fs::path& folder, bool nested, std::uint64_t max_bytes) {
  return images_of(
      nested ? files_in<fs::recursive_directory_iterator>(folder) : files_in<fs::directory_iterator>(folder),
      max_bytes);
}

DicomImages images_of_directory(const DicomHeader& dicomdir, std::uint64_t max_bytes) {
  const std::string subject = dicomdir.file.string();
  std::vector<fs::path> files;
  for (const fs::path& name : dicomdir.listed_files) {
    const std::optional<fs::path> file = file_named(dicomdir.file.parent_path(), name);
    if (!file) throw InputError(subject, fmt::format("names {}, which is not there", name.string()));
    files.push_back(*file);
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return images_of(files, max_bytes);
}

bool DicomSeries::is_ct() const {
  return headers.front().modality == "CT";
}

std::vector<SlicePlane> DicomSeries::planes() const {
  std::vector<SlicePlane> planes;
  for (const DicomHeader& header : headers) {
    if (header.fault) throw *header.fault;
    for (const DicomSlice& slice : header.slices) planes.push_back(slice.plane);
  }
  return planes;
}

std::uint64_t DicomSeries::pixel_count() const {
  std::uint64_t count = 0;
  for (const DicomHeader& header : headers) {
    count += static_cast<std::uint64_t>(header.columns) * static_cast<std::uint64_t>(header.rows) *
             header.slices.size();
  }
  return count;
}

std::vector<DicomSeries> sort_into_series(std::vector<DicomHeader> images) {
  std::vector<DicomSeries> all;
  for (DicomHeader& header : images) {
    const std::string uid =
        header.series_uid.empty() ? header.file.parent_path().string() : header.series_uid;
    auto series = std::find_if(all.begin(), all.end(), [&](const DicomSeries& s) { return s.uid == uid; });
    if (series == all.end()) series = all.insert(all.end(), {uid, {}});
    series->headers.push_back(std::move(header));
  }
  return all;
}

std::string describe_series(std::size_t number, const DicomSeries& series) {
  const DicomHeader& first = series.headers.front();
  return fmt::format("{}: {} \"{}\", {}, from {}, {}", number, first.modality, first.series_description,
                     size_and_spacing(series), first.file.filename().string(), series.uid);
}

std::size_t pick_series(const std::string& subject, const std::vector<DicomSeries>& all,
                        const std::string& wanted) {
  if (wanted.empty()) {
    const auto largest = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return std::pair(a.is_ct(), a.pixel_count()) < std::pair(b.is_ct(), b.pixel_count());
    });
    return static_cast<std::size_t>(largest - all.begin());
  }
  if (const auto number = number_of(wanted); number && *number >= 1 && *number <= all.size()) {
    return *number - 1;
  }
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].uid == wanted) return n;
    if (all[n].uid.starts_with(wanted)) found.push_back(n);
  }
  if (found.size() == 1) return found.front();
  std::string list;
  for (std::size_t n = 0; n < all.size(); ++n) list += (n > 0 ? "; " : "") + describe_series(n + 1, all[n]);
  throw InputError(
      subject, fmt::format("{} series {}, of: {}", found.empty() ? "has no" : "has several", wanted, list));
}

}  // namespace osteomill
