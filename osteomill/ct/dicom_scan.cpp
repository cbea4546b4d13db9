#include "osteomill/ct/dicom_scan.h"

#include <algorithm>

#include <fmt/format.h>

#include "osteomill/ct/dicom_data.h"
#include "osteomill/ct/dicom_file.h"
#include "osteomill/ct/dicom_series.h"
#include "osteomill/ct/plausible_scan.h"
#include "osteomill/ct/slice_stack.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// Scout views are no part of a series, even where they carry its number.
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
    images = images_in_folder(folder, true, options.max_memory_bytes);
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
  for (DicomHeader& other : images_in_folder(folder, false, max_bytes).headers) {
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
