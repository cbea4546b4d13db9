#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/work_progress.h"

#include "dicom_data.h"
#include "dicom_file.h"
#include "dicom_segmentation.h"
#include "header_text.h"
#include "plausible_scan.h"
#include "slice_stack.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Pictures found together, in order of their file names.
struct DicomImages {
  std::vector<DicomHeader> headers;
  // Number of files that are not DICOM pictures.
  std::size_t other_files = 0;
};

// Frame of one of a series' files.
struct SliceOf {
  std::size_t header;
  std::size_t frame;
};

// One series, its pictures in order of their files.
struct DicomSeries {
  std::string uid;
  std::vector<DicomHeader> headers;
  // Pictures that are not slices of the series, with the reasons.
  std::vector<std::string> left_out = {};

  bool is_ct() const { return headers.front().modality == "CT"; }
  bool has_fault() const {
    return std::any_of(headers.begin(), headers.end(),
                       [](const DicomHeader& header) { return header.fault; });
  }
  const DicomSlice& operator[](const SliceOf& slice) const {
    return headers[slice.header].slices[slice.frame];
  }
  // Returns all slices, file by file.
  std::vector<SliceOf> slices() const {
    std::vector<SliceOf> all;
    for (std::size_t n = 0; n < headers.size(); ++n) {
      for (std::size_t frame = 0; frame < headers[n].slices.size(); ++frame) all.push_back({n, frame});
    }
    return all;
  }
};

std::vector<float> densities_of(const DicomSeries& series, const SliceOf& slice) {
  const SlicePlane& plane = series[slice].plane;
  std::vector<float> densities(static_cast<std::size_t>(plane.columns) *
                               static_cast<std::size_t>(plane.rows));
  read_dicom_densities(series.headers[slice.header],
                       [&](std::size_t frame) { return frame == slice.frame ? densities.data() : nullptr; });
  return densities;
}

// A series or a part of one.
struct DicomPart {
  const DicomSeries* series;
  // Number shown to users: 3, or 3.1 if the series has several parts.
  std::string number;
  // See SeriesPart.
  std::string distinguishing_marks;
  std::vector<SliceOf> slices;

  // Returns the planes of the slices. Throws the first fault among the series' files.
  std::vector<SlicePlane> planes() const {
    for (const DicomHeader& header : series->headers) {
      if (header.fault) throw *header.fault;
    }
    std::vector<SlicePlane> planes;
    for (const SliceOf& slice : slices) planes.push_back((*series)[slice].plane);
    return planes;
  }
  SamePixels same_pixels() const {
    return [this](std::size_t a, std::size_t b) {
      const Vec3 apart_mm = (*series)[slices[a]].plane.position_mm - (*series)[slices[b]].plane.position_mm;
      if (apart_mm.norm() > kSamePlace_mm) return false;
      const std::vector<float> one = densities_of(*series, slices[a]),
                               other = densities_of(*series, slices[b]);
      // Compares bits, because padding is NaN.
      return std::memcmp(one.data(), other.data(), one.size() * sizeof(float)) == 0;
    };
  }
  bool is_volume() const {
    try {
      stack_slices("", planes(), same_pixels());
      return true;
    } catch (const InputError&) {
      return false;
    }
  }
  bool has(const fs::path& file) const {
    return std::any_of(slices.begin(), slices.end(), [&](const SliceOf& slice) {
      return series->headers[slice.header].file.filename() == file.filename();
    });
  }
  std::uint64_t pixel_count() const {
    std::uint64_t count = 0;
    for (const SliceOf& slice : slices) {
      const SlicePlane& plane = (*series)[slice].plane;
      count += static_cast<std::uint64_t>(plane.columns) * static_cast<std::uint64_t>(plane.rows);
    }
    return count;
  }
};

// Studies have some thousands of files.
constexpr std::size_t kMaxFiles = 1 << 16;

// Throws InputError, naming the folder, if it cannot be read or contains too many files.
template <typename Iterator>
std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (Iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) files.push_back(entry->path());
    if (files.size() > kMaxFiles) {
      throw InputError(folder.string(), fmt::format("holds over {} files; choose a folder in it", kMaxFiles));
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

// Names on a disc are upper case, but some systems show them in lower case.
std::optional<fs::path> file_named(const fs::path& folder, const fs::path& name) {
  std::error_code ignored;
  for (const std::string& spelling : {name.string(), lower(name.string())}) {
    if (fs::is_regular_file(folder / spelling, ignored)) return folder / spelling;
  }
  return std::nullopt;
}

// Returns size and spacing of the volume that would be read.
std::string size_and_spacing(const DicomPart& part) {
  try {
    const GridGeometry grid = stack_slices("", part.planes(), part.same_pixels()).geometry;
    return fmt::format("{} x {} x {}, {:.4g} x {:.4g} x {:.4g} mm", grid.dims[0], grid.dims[1], grid.dims[2],
                       grid.spacing_mm.x(), grid.spacing_mm.y(), grid.spacing_mm.z());
  } catch (const InputError&) {
    return fmt::format("{} slices, not a volume", part.slices.size());
  }
}

// Returns the images of the files that a DICOMDIR lists, in its folder and below. Throws InputError, naming
// the DICOMDIR, if one is missing.
DicomImages images_of_directory(const DicomHeader& dicomdir, std::uint64_t max_bytes) {
  const std::string subject = dicomdir.file.string();
  std::vector<fs::path> files;
  for (const fs::path& name : dicomdir.listed_files) {
    const std::optional<fs::path> file = file_named(dicomdir.file.parent_path(), name);
    if (!file)
      throw InputError(subject,
                       fmt::format("lists {}, which does not exist; copy the whole disc", name.string()));
    files.push_back(*file);
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return images_of(files, max_bytes);
}

// Groups pictures by series, or by folder if they name no series. Series are ordered by their first files.
std::vector<DicomSeries> sort_into_series(std::vector<DicomHeader> images) {
  std::vector<DicomSeries> all;
  for (DicomHeader& header : images) {
    const std::string uid =
        header.series_uid.empty() ? header.file.parent_path().string() : header.series_uid;
    auto series = std::find_if(all.begin(), all.end(), [&](const DicomSeries& s) { return s.uid == uid; });
    if (series == all.end()) series = all.insert(all.end(), {uid, {}, {}});
    series->headers.push_back(std::move(header));
  }
  return all;
}

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// Excludes pictures of a series that are not slices, unless it has no others.
void exclude_pictures(DicomSeries& series) {
  const auto first = std::stable_partition(
      series.headers.begin(), series.headers.end(),
      [](const DicomHeader& header) { return header.no_slice.empty() || !header.fault; });
  if (first == series.headers.begin()) return;
  for (auto header = first; header != series.headers.end(); ++header)
    series.left_out.push_back(fmt::format("{}, {}", header->file.filename().string(), header->no_slice));
  series.headers.erase(first, series.headers.end());
}

// Excludes single slices that fit no others, unless there are at least as many as the largest part has
// slices.
void exclude_slices(DicomSeries& series, std::vector<DicomPart>& parts) {
  const auto largest = std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
    return a.slices.size() < b.slices.size();
  });
  const SlicePlane& usual = series[largest->slices.front()].plane;
  const auto is_single = [](const DicomPart& part) { return part.slices.size() == 1; };
  const auto singles = std::count_if(parts.begin(), parts.end(), is_single);
  if (static_cast<std::size_t>(singles) >= largest->slices.size()) return;
  for (const DicomPart& part : parts) {
    if (!is_single(part)) continue;
    const SlicePlane& plane = series[part.slices.front()].plane;
    const char* const difference = difference_of(usual, plane);
    series.left_out.push_back(difference != nullptr
                                  ? fmt::format("{}, of another {}", plane.name, difference)
                                  : fmt::format("{}, {}", plane.name, part.distinguishing_marks));
  }
  std::erase_if(parts, is_single);
}

// Returns the choices in a series: all of it or, if that is not one volume, its parts.
std::vector<DicomPart> parts_of(DicomSeries& series, std::size_t number) {
  exclude_pictures(series);
  const DicomPart whole{&series, fmt::format("{}", number), "", series.slices()};
  if (series.has_fault() || whole.slices.empty()) return {whole};
  std::vector<SliceMarks> marks;
  for (const SliceOf& slice : whole.slices) marks.push_back(series[slice].marks);
  std::vector<DicomPart> parts;
  for (const SeriesPart& found : split_series(whole.planes(), marks, whole.same_pixels())) {
    DicomPart& part = parts.emplace_back(DicomPart{&series, whole.number, found.distinguishing_marks, {}});
    for (const std::size_t n : found.slices) part.slices.push_back(whole.slices[n]);
  }
  exclude_slices(series, parts);
  if (std::any_of(parts.begin(), parts.end(), [](const DicomPart& part) { return part.slices.size() < 2; }))
    return {whole};
  for (std::size_t n = 0; n < parts.size() && parts.size() > 1; ++n)
    parts[n].number += fmt::format(".{}", n + 1);
  return parts;
}

SeriesSummary summary_of(const DicomPart& part) {
  const DicomHeader& first = part.series->headers[part.slices.empty() ? 0 : part.slices.front().header];
  SeriesSummary summary{part.number,
                        first.modality,
                        in_one_line(first.series_description),
                        part.distinguishing_marks,
                        part.slices.size(),
                        first.columns,
                        first.rows,
                        {}};
  try {
    summary.thickness_mm = stack_slices("", part.planes(), part.same_pixels()).geometry.spacing_mm.z();
  } catch (const InputError&) {
    // Not a volume.
  }
  return summary;
}

// Describes a series in one line: number, modality, description, distinguishing mark, size, spacing, first
// file, UID.
std::string describe(const DicomPart& part) {
  const DicomHeader& first = part.series->headers[part.slices.empty() ? 0 : part.slices.front().header];
  return fmt::format("{}: {} \"{}\", {}{}{}, from {}, {}", part.number, first.modality,
                     first.series_description, part.distinguishing_marks,
                     part.distinguishing_marks.empty() ? "" : ", ", size_and_spacing(part),
                     first.file.filename().string(), in_one_line(part.series->uid));
}

// Returns the part with the most pixels; prefers CT to other modalities and, within a series, parts that form
// a volume.
const DicomPart& largest_of(const std::vector<DicomPart>& all) {
  const auto has_parts = [](const DicomPart& part) { return part.number.find('.') != std::string::npos; };
  std::vector<std::pair<bool, std::uint64_t>> sizes;
  for (const DicomPart& part : all) {
    const bool counts = !has_parts(part) || part.is_volume();
    sizes.emplace_back(part.series->is_ct(), counts ? part.pixel_count() : 0);
  }
  return all[static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin())];
}

// Returns the part that matches `wanted`: its number, a UID or a prefix of one. If empty, returns the part
// with `file`, or the largest. Throws InputError, naming `subject`, if no part matches, or parts of several
// series do.
const DicomPart& pick_part(const std::string& subject, const std::vector<DicomPart>& all,
                           const std::string& wanted, const fs::path& file) {
  std::vector<DicomPart> found;
  const auto add_if = [&](const auto& fits) {
    if (found.empty()) std::copy_if(all.begin(), all.end(), std::back_inserter(found), fits);
  };
  if (wanted.empty() && file.empty()) return largest_of(all);
  if (wanted.empty()) add_if([&](const DicomPart& part) { return part.has(file); });
  const auto begins = [&](const DicomPart& part) { return part.series->uid.starts_with(wanted); };
  if (!wanted.empty()) {
    add_if([&](const DicomPart& part) { return part.number == wanted; });
    add_if([&](const DicomPart& part) { return part.number.starts_with(wanted + "."); });
    add_if([&](const DicomPart& part) { return part.series->uid == wanted; });
    add_if(begins);
  }
  const bool of_one_series =
      !found.empty() && std::all_of(found.begin(), found.end(), [&](const DicomPart& part) {
        return part.series == found.front().series;
      });
  if (of_one_series) {
    const std::string number = largest_of(found).number;
    return *std::find_if(all.begin(), all.end(),
                         [&](const DicomPart& part) { return part.number == number; });
  }
  if (wanted.empty()) throw InputError(subject, "is a separate picture, not a slice of a scan");
  std::string list;
  for (const DicomPart& part : all) list += (list.empty() ? "" : "; ") + describe(part);
  throw InputError(
      subject, fmt::format("{} series {}, of: {}", found.empty() ? "has no" : "has several", wanted, list));
}

// Scout views are not part of a series, even if they have its UID.
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
    warnings.push_back("MONOCHROME1, meant for inverted display: the densities are not inverted");
  }
  if (!first.modality.empty() && first.modality != "CT") {
    warnings.push_back(
        fmt::format("the modality is {}, not CT: densities are not Hounsfield units", first.modality));
  }
}

// Reads the densities, slice by slice in the order of the stack.
std::vector<float> read_densities(const DicomPart& part, const SliceStack& stack,
                                  std::vector<DicomHeader>& headers, std::vector<std::string>& warnings) {
  const std::size_t slice_size =
      stack.geometry.voxel_count() / static_cast<std::size_t>(stack.geometry.dims[2]);
  std::vector<float> densities(slice_size * stack.order.size());
  std::vector<std::vector<float*>> places;
  for (const DicomHeader& header : headers) places.emplace_back(header.slices.size(), nullptr);
  for (std::size_t k = 0; k < stack.order.size(); ++k) {
    const SliceOf& slice = part.slices[stack.order[k]];
    places[slice.header][slice.frame] = &densities[k * slice_size];
  }
  std::size_t read = 0;
  bool has_sign_mismatch = false;
  for (std::size_t n = 0; n < headers.size(); ++n) {
    has_sign_mismatch |= read_dicom_densities(headers[n], [&](std::size_t frame) {
      if (places[n][frame] != nullptr) WorkProgress::done(read++, stack.order.size());
      return places[n][frame];
    });
    headers[n].data.reset();
  }
  if (has_sign_mismatch) {
    warnings.push_back(
        "its compressed pixels are signed but its header says unsigned: they were read as signed");
  }
  return densities;
}

// Warns if some of the files of a split image are missing.
void check_concatenation(const DicomPart& part, std::vector<std::string>& warnings) {
  std::set<std::pair<std::string, int>> found;
  int total = 0;
  for (const SliceOf& slice : part.slices) {
    const auto& of = part.series->headers[slice.header].concatenation;
    if (!of) continue;
    found.insert({of->uid, of->number});
    total = std::max({total, of->total, of->number});
  }
  if (found.size() < static_cast<std::size_t>(total)) {
    warnings.push_back(fmt::format("is incomplete: {} of the {} files of its image", found.size(), total));
  }
}

// Warns if slice numbers are not monotonic along the stack, unless all are equal: the slices may be of
// several scans that nothing else distinguishes.
void check_numbers(const DicomPart& part, const SliceStack& stack, std::vector<std::string>& warnings) {
  std::vector<const SlicePlane*> planes;
  for (const std::size_t n : stack.order) {
    planes.push_back(&(*part.series)[part.slices[n]].plane);
    if (!planes.back()->number) return;
  }
  const auto has_first = [&](const SlicePlane* plane) { return plane->number == planes.front()->number; };
  if (std::all_of(planes.begin(), planes.end(), has_first)) return;
  const auto step = [&](std::size_t k) { return std::int64_t{*planes[k]->number} - *planes[k - 1]->number; };
  for (std::size_t k = 2; k < planes.size(); ++k) {
    if ((step(k) > 0) == (step(1) > 0) && step(k) != 0 && step(1) != 0) continue;
    warnings.push_back(fmt::format(
        "slices are not in the order of their numbers, {}, {}, {} ({} to {}): they may be of several scans",
        *planes[k - 2]->number, *planes[k - 1]->number, *planes[k]->number, planes[k - 2]->name,
        planes[k]->name));
    return;
  }
}

// Warns of densities that no CT has, which indicate a wrong sign or byte order in the header. Padding is
// about -3024 or less; metal may reach 30 000 on extended scales.
void check_hounsfield_units(const std::vector<float>& densities, std::vector<std::string>& warnings) {
  constexpr float kLeast = -10'000, kMost = 32'767;
  float least = 0, most = 0;
  for (const float density : densities) {
    least = std::min(least, density);
    most = std::max(most, density);
  }
  if (least >= kLeast && most <= kMost) return;
  warnings.push_back(
      fmt::format("has densities from {:.6g} to {:.6g}, outside the range of CT in Hounsfield units: its "
                  "header may be wrong about the sign or the rescaling of its pixels",
                  least, most));
}

Scan build_scan(const std::string& subject, const DicomPart& part, std::vector<DicomHeader>& headers,
                std::vector<std::string> warnings, const ReadOptions& options) {
  SliceStack stack = stack_slices(subject, part.planes(), part.same_pixels());
  const bool is_moved = !stack.heights_mm.empty() || stack.drift_i_mm != 0 || stack.drift_j_mm != 0;
  check_memory(subject, (is_moved ? 2 : 1) * stack.geometry.voxel_count(), options.max_memory_bytes);
  const DicomHeader& first = headers[part.slices.front().header];
  add_notes(first, warnings);
  check_concatenation(part, warnings);
  if (!first.warning.empty()) warnings.push_back(first.warning);
  const bool in_hounsfield_units = first.in_hounsfield_units;
  std::vector<float> densities;
  {
    const WorkProgress::Part reading(0.95);
    densities = read_densities(part, stack, headers, warnings);
  }
  const WorkProgress::Part checking(1);
  check_densities(subject, densities);
  if (in_hounsfield_units) check_hounsfield_units(densities, warnings);
  check_numbers(part, stack, warnings);
  resample_to_even_slices(stack, densities);
  correct_gantry_tilt(subject, stack, densities);
  warnings.insert(warnings.end(), stack.warnings.begin(), stack.warnings.end());
  return {DensityGrid(stack.geometry, std::move(densities)), subject, "DICOM", std::move(warnings),
          in_hounsfield_units};
}

// Warns which series was chosen automatically, and lists the others.
void add_choice(const DicomPart& picked, const std::vector<DicomPart>& all, std::size_t series_count,
                const std::string& wanted, std::vector<std::string>& warnings) {
  if (series_count > 1 && wanted.empty()) {
    warnings.push_back(fmt::format("holds {} series; the largest{} was read, {}", series_count,
                                   picked.series->is_ct() ? " CT" : "", describe(picked)));
  }
  std::string others;
  for (const DicomPart& part : all) {
    if (part.series == picked.series && part.number != picked.number)
      others +=
          fmt::format("{}{} ({})", others.empty() ? "" : ", ", part.number,
                      part.distinguishing_marks.empty() ? size_and_spacing(part) : part.distinguishing_marks);
  }
  if (!others.empty() && wanted != picked.number) {
    warnings.push_back(
        fmt::format("a series holds several volumes; {} was read{}{}{}, choose with --series: {}",
                    picked.number, picked.distinguishing_marks.empty() ? "" : " (",
                    picked.distinguishing_marks, picked.distinguishing_marks.empty() ? "" : ")", others));
  }
}

// Excludes segmentations next to other pictures; --labels reads them.
void drop_segmentations(std::vector<DicomHeader>& images, std::vector<std::string>& warnings) {
  const auto first = std::stable_partition(images.begin(), images.end(),
                                           [](const DicomHeader& header) { return !header.is_segmentation; });
  if (first == images.end() || first == images.begin()) return;
  warnings.push_back(fmt::format("{} left out; read it with --labels: {}",
                                 counted(static_cast<std::size_t>(images.end() - first), "segmentation"),
                                 first->file.filename().string()));
  images.erase(first, images.end());
}

// Reads one of possibly several series; that of `file`, if given.
Scan read_images(const std::string& subject, DicomImages images, const ReadOptions& options,
                 const fs::path& file = {}) {
  std::vector<std::string> warnings;
  if (images.other_files > 0) {
    warnings.push_back(fmt::format("{} left out: not DICOM images", counted(images.other_files, "file")));
  }
  for (const DicomHeader& header : images.headers) {
    if (header.lost) throw *header.fault;
  }
  const std::size_t pictures = images.headers.size();
  drop_localizers(images.headers, warnings);
  if (images.headers.empty()) {
    throw InputError(subject, pictures == 0 ? "holds no DICOM slices"
                                            : fmt::format("holds no slices of a scan, only {}",
                                                          counted(pictures, "localizer")));
  }
  drop_segmentations(images.headers, warnings);
  if (images.headers.front().is_segmentation) {
    if (images.headers.size() > 1)
      throw InputError(subject,
                       fmt::format("holds {} segmentations; choose one of them", images.headers.size()));
    if (images.headers.front().fault) throw *images.headers.front().fault;
    return read_segmentation(subject, images.headers.front(), options);
  }
  std::vector<DicomSeries> all = sort_into_series(std::move(images.headers));
  std::vector<DicomPart> parts;
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (DicomPart& part : parts_of(all[n], n + 1)) parts.push_back(std::move(part));
  }
  std::string wanted = options.series;
  if (parts.size() > 1 && wanted.empty() && file.empty() && options.choose_series) {
    std::vector<SeriesSummary> choices;
    for (const DicomPart& part : parts) choices.push_back(summary_of(part));
    wanted = options.choose_series(choices);
  }
  const DicomPart& picked = pick_part(subject, parts, wanted, file);
  std::vector<std::string> lines;
  for (const DicomPart& part : parts) {
    if (parts.size() > 1) lines.push_back(describe(part));
  }
  add_choice(picked, parts, all.size(), wanted, warnings);
  DicomSeries& series =
      *std::find_if(all.begin(), all.end(), [&](const DicomSeries& of) { return &of == picked.series; });
  if (!series.left_out.empty()) {
    warnings.push_back(fmt::format("{} left out: {}{}", counted(series.left_out.size(), "picture"),
                                   series.left_out.front(), series.left_out.size() > 1 ? "; ..." : ""));
  }
  try {
    Scan scan = build_scan(subject, picked, series.headers, warnings, options);
    scan.series = std::move(lines);
    return scan;
  } catch (const InputError& fault) {
    std::string more;
    if (lines.size() > 1) more = fmt::format("it is series {} of {}", picked.number, all.size());
    if (!series.left_out.empty()) more += (more.empty() ? "" : "; ") + warnings.back();
    if (more.empty()) throw;
    throw InputError(fault.what(), more);
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

// Collects the files of a series from the folder of one of them.
DicomImages series_of(DicomHeader header, std::uint64_t max_bytes) {
  const fs::path file = header.file;
  const std::string uid = header.series_uid;
  const bool alone = uid.empty();
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
  if (!header->is_image() && !header->is_directory() && !header->lost) {
    const std::string& kind = header->modality;
    throw InputError(subject, fmt::format("is DICOM, but not an image{}{}", kind.empty() ? "" : ": ", kind));
  }
  if (header->fault) throw *header->fault;
  if (header->is_directory())
    return read_images(subject, images_of_directory(*header, options.max_memory_bytes), options);
  if (header->is_segmentation) return read_segmentation(subject, *header, options);
  if (header->is_localizer) throw InputError(subject, "is a localizer, not a slice of a scan");
  return read_images(subject, series_of(std::move(*header), options.max_memory_bytes), options, file);
}

}  // namespace

std::optional<Scan> read_dicom(const fs::path& path, const ReadOptions& options) {
  std::optional<Scan> scan;
  with_dicom_stack(
      [&] { scan = fs::is_directory(path) ? read_folder(path, options) : read_file(path, options); });
  return scan;
}

}  // namespace osteomill
