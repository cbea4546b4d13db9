#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

/// Returns whether a file's name is that of a PNG or TIFF file.
bool is_picture(const std::filesystem::path& path);

/// Reads pictures as slices in natural order of their names (slice 2 before slice 10), then of the pages in a
/// TIFF file. Columns run along i, rows along j. Grey values are as stored; in colour pictures each colour is
/// a label, and black or transparent pixels have none. Throws InputError naming the picture if it cannot be
/// read or differs in size or kind, and naming `subject` if a number in the names is missing, the names
/// differ in more than numbers, or the options have no spacing.
Scan read_pictures(const std::filesystem::path& subject, std::vector<std::filesystem::path> files,
                   const ReadOptions& options);

}  // namespace osteomill
