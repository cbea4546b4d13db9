#include "osteomill/ct/dicom_series.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "osteomill/ct/dicom_data.h"
#include "osteomill/ct/dicom_file.h"
#include "osteomill/ct/dicom_pixels.h"
#include "osteomill/ct/gantry_tilt.h"
#include "osteomill/ct/plausible_scan.h"
#include "osteomill/ct/slice_stack.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

using Headers = std::vector<DicomHeader>;

struct Folder {
  /// Pictures, in the order of their names.
  Headers images;
  std::size_t other_files = 0;
  bool has_folders = false;
};

std::string counted(std::size_t count, const std::string& noun, const std::string& plural_ending = "s") {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : plural_ending);
}

// All files of the folder but `known`.
Folder read_headers(const fs::path& folder, const fs::path& known = {}) {
  std::error_code error;
  std::vector<fs::path> files;
  Folder result;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_directory(ignored)) result.has_folders = true;
    if (entry->is_regular_file(ignored) && entry->path().filename() != known) files.push_back(entry->path());
  }
  if (error) throw InputError(folder.string(), "cannot be read: " + error.message());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    WorkProgress::done(result.images.size() + result.other_files, files.size());
    std::optional<DicomHeader> header = read_dicom_header(file);
    if (header && (header->is_image() || header->lost)) {
      result.images.push_back(std::move(*header));
    } else {
      ++result.other_files;
    }
  }
  return result;
}

std::size_t slice_count(const Headers& series) {
  std::size_t count = 0;
  for (const DicomHeader& header : series) count += header.slices.size();
  return count;
}

std::string series_name(const Headers& series) {
  const DicomHeader& first = series.front();
  const std::string title = first.series_description.empty() ? first.series_uid : first.series_description;
  return fmt::format("\"{}\" ({}, from {})", title, counted(slice_count(series), "slice"),
                     first.file.filename().string());
}

// Scout views are no part of a series, even where they carry its number.
void drop_localizers(Headers& images, std::vector<std::string>& warnings) {
  const auto first = std::stable_partition(images.begin(), images.end(),
                                           [](const DicomHeader& header) { return !header.is_localizer; });
  const auto count = static_cast<std::size_t>(images.end() - first);
  if (count == 0) return;
  warnings.push_back(
      fmt::format("{} left out: {}", counted(count, "localizer"), first->file.filename().string()));
  images.erase(first, images.end());
}

// The series with the most slices that can be read; of equal ones that of the first file.
Headers pick_series(Headers images, std::vector<std::string>& warnings) {
  std::vector<Headers> all;
  for (DicomHeader& header : images) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const Headers& series) {
      return series.front().series_uid == header.series_uid;
    });
    if (same == all.end()) {
      all.emplace_back();
      all.back().push_back(std::move(header));
    } else {
      same->push_back(std::move(header));
    }
  }
  const auto largest = std::max_element(all.begin(), all.end(), [](const Headers& a, const Headers& b) {
    return slice_count(a) < slice_count(b);
  });
  if (all.size() > 1) {
    std::string others;
    for (const Headers& series : all) {
      if (&series != &*largest) others += (others.empty() ? "" : ", ") + series_name(series);
    }
    warnings.push_back(fmt::format("{} in this folder: series {} was read, left out: {}",
                                   counted(all.size(), "series", ""), series_name(*largest), others));
  }
  return std::move(*largest);
}

void check_series(const Headers& series) {
  for (const DicomHeader& header : series) {
    if (header.fault) throw *header.fault;
  }
}

void add_notes(const Headers& series, std::vector<std::string>& warnings) {
  const DicomHeader& first = series.front();
  if (first.photometric == "MONOCHROME1") {
    warnings.push_back("MONOCHROME1: meant to be shown inverted; the densities are taken as they are");
  }
  if (!first.modality.empty() && first.modality != "CT") {
    warnings.push_back(
        fmt::format("the modality is {}, not CT: densities are not Hounsfield units", first.modality));
  }
}

std::vector<float> read_densities(Headers& series, const SliceStack& stack,
                                  const std::vector<DicomSlice>& slices) {
  std::map<std::pair<fs::path, std::size_t>, std::size_t> place_of_frame;
  for (std::size_t k = 0; k < stack.order.size(); ++k) {
    const DicomSlice& slice = slices[stack.order[k]];
    place_of_frame[{slice.file, slice.frame}] = k;
  }
  const std::size_t slice_size = stack.geometry.voxel_count() / stack.order.size();
  std::vector<float> densities(stack.geometry.voxel_count());
  std::size_t read = 0;
  for (DicomHeader& header : series) {
    read_dicom_densities(header, [&](std::size_t frame) -> float* {
      WorkProgress::done(read++, slices.size());
      const auto place = place_of_frame.find({header.file, frame});
      return place == place_of_frame.end() ? nullptr : densities.data() + place->second * slice_size;
    });
    header.data.reset();
  }
  return densities;
}

Scan build_scan(const std::string& subject, Headers series, std::vector<std::string> warnings) {
  check_series(series);
  std::vector<DicomSlice> slices;
  std::vector<SlicePlane> planes;
  for (const DicomHeader& header : series) {
    for (const DicomSlice& slice : header.slices) {
      slices.push_back(slice);
      planes.push_back(slice.plane);
    }
  }
  SliceStack stack = stack_slices(subject, planes);
  add_notes(series, warnings);
  std::vector<float> densities;
  {
    const WorkProgress::Part reading(0.95);
    densities = read_densities(series, stack, slices);
  }
  const WorkProgress::Part checking(1);
  check_finite(subject, densities);
  correct_gantry_tilt(subject, stack, densities);
  warnings.insert(warnings.end(), stack.warnings.begin(), stack.warnings.end());
  return {DensityGrid(stack.geometry, std::move(densities)), subject, "DICOM", std::move(warnings),
          series.front().in_hounsfield_units};
}

void warn_of_other_files(std::size_t count, std::vector<std::string>& warnings) {
  if (count > 0) {
    warnings.push_back(fmt::format("{} in this folder left out: not DICOM images", counted(count, "file")));
  }
}

Scan read_folder(const fs::path& folder) {
  const std::string subject = folder.string();
  Folder found;
  {
    const WorkProgress::Part looking(0.3);
    found = read_headers(folder);
  }
  const WorkProgress::Part reading(1);
  for (const DicomHeader& header : found.images) {
    if (header.lost) throw *header.fault;
  }
  std::vector<std::string> warnings;
  warn_of_other_files(found.other_files, warnings);
  drop_localizers(found.images, warnings);
  if (found.images.empty()) {
    throw InputError(subject, found.has_folders
                                  ? "holds no DICOM slices itself; name the folder within it that does"
                                  : "holds no DICOM slices");
  }
  Headers series = pick_series(std::move(found.images), warnings);
  return build_scan(subject, std::move(series), std::move(warnings));
}

// `series` holds one file; the others are beside it.
void add_rest_of_series(Headers& series) {
  const fs::path file = series.front().file;
  const std::string uid = series.front().series_uid;
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  for (DicomHeader& other : read_headers(folder, file.filename()).images) {
    if (!other.lost && other.series_uid == uid && !other.is_localizer) series.push_back(std::move(other));
  }
  std::sort(series.begin(), series.end(),
            [](const DicomHeader& a, const DicomHeader& b) { return a.file.filename() < b.file.filename(); });
}

std::optional<Scan> read_file(const fs::path& file) {
  const std::string subject = file.string();
  std::optional<DicomHeader> header = read_dicom_header(file);
  if (!header) return std::nullopt;
  if (header->fault) throw *header->fault;
  if (!header->is_image()) throw InputError(subject, "is DICOM, but not an image");
  if (header->is_localizer) throw InputError(subject, "is a localizer, not a slice of a scan");
  Headers series;
  series.push_back(std::move(*header));
  if (series.front().frames == 1 && !series.front().series_uid.empty()) add_rest_of_series(series);
  return build_scan(subject, std::move(series), {});
}

}  // namespace

Scan read_dicom_folder(const fs::path& folder) {
  std::optional<Scan> scan;
  with_dicom_stack([&] { scan = read_folder(folder); });
  return std::move(*scan);
}

std::optional<Scan> read_dicom_file(const fs::path& file) {
  std::optional<Scan> scan;
  with_dicom_stack([&] { scan = read_file(file); });
  return scan;
}

}  // namespace osteomill
