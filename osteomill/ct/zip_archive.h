#pragma once

#include <cstdint>
#include <filesystem>

namespace osteomill {

/// Whether a file begins as zip archives do.
bool is_zip(const std::filesystem::path& file);

/// Unpacks the files of a zip archive into `folder`, where they have the names that they have in it. Throws
/// InputError naming the archive where it is damaged or encrypted, where a name leads out of the folder, or
/// where it unpacks to more than `max_bytes`, whatever its own directory says of that.
void unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                std::uint64_t max_bytes);

}  // namespace osteomill
