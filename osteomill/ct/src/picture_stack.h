#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/ct/read_scan.h"

namespace osteomill {

/// Returns whether a file is PNG or TIFF by its name.
bool is_picture(const std::filesystem::path& path);

/// Reads pictures as slices, in the order of their names (slice 2 before slice 10), and of the pages in a
/// TIFF file. Columns run along i and rows along j. Grey values are as stored; if the pictures are in colour,
/// each colour is a label, and black and what is transparent none. Throws InputError naming the picture
/// if one cannot be read or is of another size or kind, or naming `subject` if the numbers in their names
/// leave one out, their names differ in more, or the options do not say how far the voxels lie apart.
Scan read_pictures(const std::filesystem::path& subject, std::vector<std::filesystem::path> files,
                   const ReadOptions& options);

}  // namespace osteomill
