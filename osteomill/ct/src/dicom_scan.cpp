#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/work_progress.h"

#include "dicom_data.h"
#include "dicom_file.h"
#include "header_text.h"
#include "plausible_scan.h"
#include "slice_stack.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Pictures that were found together, in the order of their files' names.
struct DicomImages {
  std::vector<DicomHeader> headers;
  // Files that are no DICOM pictures.
  std::size_t other_files = 0;
};

// One series: pictures that were taken together, in the order of their files.
struct DicomSeries {
  std::string uid;
  std::vector<DicomHeader> headers;

  bool is_ct() const { return headers.front().modality == "CT"; }
  // Returns the planes of every slice, file by file. Throws the first fault of a file.
  std::vector<SlicePlane> planes() const {
    std::vector<SlicePlane> planes;
    for (const DicomHeader& header : headers) {
      if (header.fault) throw *header.fault;
      for (const DicomSlice& slice : header.slices) planes.push_back(slice.plane);
    }
    return planes;
  }
  // Returns the number of pixels of the readable slices.
  std::uint64_t pixel_count() const {
    std::uint64_t count = 0;
    for (const DicomHeader& header : headers) {
      count += static_cast<std::uint64_t>(header.columns) * static_cast<std::uint64_t>(header.rows) *
               header.slices.size();
    }
    return count;
  }
};

// A study has some thousands.
constexpr std::size_t kMaxFiles = 1 << 16;

// Throws InputError naming the folder if it cannot be read or holds too many files.
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

// Returns size and spacing with which the series would be read.
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

// Returns the images of the files that a DICOMDIR names, which lie beside and below it. Throws InputError
// naming it if it names one that is not there.
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

// Sorts pictures by their series; if no series is named, by their folder. In the order of their first
// files.
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

// Returns a line that describes a series to a user: number, modality, description, size, spacing, where it
// lies, UID.
std::string describe_series(std::size_t number, const DicomSeries& series) {
  const DicomHeader& first = series.headers.front();
  return fmt::format("{}: {} \"{}\", {}, from {}, {}", number, first.modality, first.series_description,
                     size_and_spacing(series), first.file.filename().string(), series.uid);
}

// Which of `all` is `wanted`: a number from 1, a UID or the beginning of one. Empty: the one with the most
// pixels, CT before others. Throws InputError naming `subject` if none, or more than one, is.
std::size_t pick_series(const std::string& subject, const std::vector<DicomSeries>& all,
                        const std::string& wanted) {
  if (wanted.empty()) {
    const auto largest = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return std::pair(a.is_ct(), a.pixel_count()) < std::pair(b.is_ct(), b.pixel_count());
    });
    return static_cast<std::size_t>(largest - all.begin());
  }
  if (const auto number = parsed_number<std::size_t>(wanted);
      number && *number >= 1 && *number <= all.size()) {
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

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// Scout views are no part of a series, even if they carry its number.
void drop_localizers(std::vector<DicomHeader>& images, std::vector<std::string>& warnings) {
  const auto first = std::stable_partition(images.begin(), images.end(),
                                           [](const DicomHeader& header) { return !header.is_localizer; });
  const auto count = static_cast<std::size_t>(images.end() - first);
  if (count == 0) return;
  warnings.push_back(
      fmt::format("{} left out: {}", counted(count, "localizer"), first->file.filename().string()));
  images.erase(first, images.end());
}

void add_notes(const DicomHeader& first, std::vector<std::string>& warnings) {
  if (first.photometric == "MONOCHROME1") {
    warnings.push_back("MONOCHROME1: meant to be shown inverted; the densities are taken as they are");
  }
  if (!first.modality.empty() && first.modality != "CT") {
    warnings.push_back(
        fmt::format("the modality is {}, not CT: densities are not Hounsfield units", first.modality));
  }
}

// Slice after slice, as the stack has them.
std::vector<float> read_densities(DicomSeries& series, const SliceStack& stack, std::size_t slices) {
  const std::size_t slice_size =
      stack.geometry.voxel_count() / static_cast<std::size_t>(stack.geometry.dims[2]);
  std::vector<float> densities(slice_size * stack.order.size());
  std::vector<float*> of_slice(slices, nullptr);
  for (std::size_t k = 0; k < stack.order.size(); ++k) of_slice[stack.order[k]] = &densities[k * slice_size];
  std::size_t read = 0;
  for (DicomHeader& header : series.headers) {
    read_dicom_densities(header, [&](std::size_t /*frame*/) {
      WorkProgress::done(read, slices);
      return of_slice[read++];
    });
    header.data.reset();
  }
  return densities;
}

Scan build_scan(const std::string& subject, DicomSeries series, std::vector<std::string> warnings,
                const ReadOptions& options) {
  const std::vector<SlicePlane> planes = series.planes();
  SliceStack stack = stack_slices(subject, planes);
  const bool is_moved = !stack.heights_mm.empty() || stack.drift_i_mm != 0 || stack.drift_j_mm != 0;
  check_memory(subject, (is_moved ? 2 : 1) * stack.geometry.voxel_count(), options.max_memory_bytes);
  add_notes(series.headers.front(), warnings);
  std::vector<float> densities;
  {
    const WorkProgress::Part reading(0.95);
    densities = read_densities(series, stack, planes.size());
  }
  const WorkProgress::Part checking(1);
  check_densities(subject, densities);
  even_out_slices(stack, densities);
  correct_gantry_tilt(subject, stack, densities);
  warnings.insert(warnings.end(), stack.warnings.begin(), stack.warnings.end());
  return {DensityGrid(stack.geometry, std::move(densities)), subject, "DICOM", std::move(warnings),
          series.headers.front().in_hounsfield_units};
}

// One of what may be several series.
Scan read_images(const std::string& subject, DicomImages images, const ReadOptions& options) {
  std::vector<std::string> warnings;
  if (images.other_files > 0) {
    warnings.push_back(fmt::format("{} left out: not DICOM images", counted(images.other_files, "file")));
  }
  for (const DicomHeader& header : images.headers) {
    if (header.lost) throw *header.fault;
  }
  drop_localizers(images.headers, warnings);
  if (images.headers.empty()) throw InputError(subject, "holds no DICOM slices");
  std::vector<DicomSeries> all = sort_into_series(std::move(images.headers));
  const std::size_t picked = pick_series(subject, all, options.series);
  std::vector<std::string> lines;
  for (std::size_t n = 0; n < all.size() && all.size() > 1; ++n)
    lines.push_back(describe_series(n + 1, all[n]));
  if (lines.empty()) return build_scan(subject, std::move(all.front()), std::move(warnings), options);
  if (options.series.empty()) {
    warnings.push_back(fmt::format("holds {} series; the largest{} was read, {}", all.size(),
                                   all[picked].is_ct() ? " CT" : "", lines[picked]));
  }
  try {
    Scan scan = build_scan(subject, std::move(all[picked]), std::move(warnings), options);
    scan.series = std::move(lines);
    return scan;
  } catch (const InputError& fault) {
    throw InputError(fault.what(), fmt::format("it is series {} of {}", picked + 1, all.size()));
  }
}

std::optional<Scan> read_folder(const fs::path& folder, const ReadOptions& options) {
  DicomImages images;
  {
    const WorkProgress::Part looking(0.3);
    images = images_of(files_in<fs::recursive_directory_iterator>(folder), options.max_memory_bytes);
  }
  const WorkProgress::Part reading(1);
  if (images.headers.empty()) return std::nullopt;
  return read_images(folder.string(), std::move(images), options);
}

// The others of its series are beside it.
DicomImages series_of(DicomHeader header, std::uint64_t max_bytes) {
  const fs::path file = header.file;
  const std::string uid = header.series_uid;
  const bool alone = header.frames > 1 || uid.empty();
  DicomImages images;
  images.headers.push_back(std::move(header));
  if (alone) return images;
  const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  for (DicomHeader& other : images_of(files_in<fs::directory_iterator>(folder), max_bytes).headers) {
    if (!other.lost && other.series_uid == uid && !other.is_localizer &&
        other.file.filename() != file.filename())
      images.headers.push_back(std::move(other));
  }
  std::sort(images.headers.begin(), images.headers.end(),
            [](const DicomHeader& a, const DicomHeader& b) { return a.file.filename() < b.file.filename(); });
  return images;
}

std::optional<Scan> read_file(const fs::path& file, const ReadOptions& options) {
  const std::string subject = file.string();
  std::optional<DicomHeader> header = read_dicom_header(file, options.max_memory_bytes);
  if (!header) return std::nullopt;
  if (header->fault) throw *header->fault;
  if (header->is_directory())
    return read_images(subject, images_of_directory(*header, options.max_memory_bytes), options);
  if (!header->is_image()) throw InputError(subject, "is DICOM, but not an image");
  if (header->is_localizer) throw InputError(subject, "is a localizer, not a slice of a scan");
  return read_images(subject, series_of(std::move(*header), options.max_memory_bytes), options);
}

}  // namespace

std::optional<Scan> read_dicom(const fs::path& path, const ReadOptions& options) {
  std::optional<Scan> scan;
  with_dicom_stack(
      [&] { scan = fs::is_directory(path) ? read_folder(path, options) : read_file(path, options); });
  return scan;
}

}  // namespace osteomill
