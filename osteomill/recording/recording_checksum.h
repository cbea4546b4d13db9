#pragma once

#include <cstddef>
#include <filesystem>

namespace osteomill {

/// The bytes before the HDF5 part of a recording (HDF5's "user block"), which hold one line of text with the
/// checksum (CRC-32) of all that follows. HDF5 crashes on some damaged files, so a damaged recording must be
/// known before HDF5 sees it.
inline constexpr std::size_t kUserBlockBytes = 512;

/// Writes the line into a recording that is finished and closed. Throws InputError where that fails.
void write_checksum(const std::filesystem::path& path);

/// `none`: an unfinished recording, or one that another program has rewritten.
enum class Checksum : unsigned char { none, intact, broken };

/// Throws InputError where the file cannot be read.
Checksum check_checksum(const std::filesystem::path& path);

}  // namespace osteomill
