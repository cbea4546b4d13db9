#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "osteomill/volume/density_block.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// A bone that was milled, as what it is of and what has changed of it.
struct MilledBone {
  /// Where the scan was read from; empty for the built-in tooth.
  std::string scan;
  /// Which series of it was asked for, where its labels are, and which of them no burr may touch, all in the
  /// user's words; empty where that was left open.
  std::string series;
  std::string labels;
  std::string label_table;
  std::vector<std::string> no_go;
  /// As the user knows it.
  std::string name;
  double isovalue = 0;
  double removed_mm3 = 0;
  std::array<int, 3> dims{};
  /// Of the scan's densities as they were read (fingerprint_of, density_grid.h).
  std::uint64_t fingerprint = 0;
  /// Every brick that was ever milled, as it is now.
  std::vector<DensityBlock> bricks;
};

/// Throws InputError, naming the scan that was read, where the other was milled of another.
void require_same_scan(const MilledBone& milled, const MilledBone& read);

/// A line of text for each fact, then the bricks as they lie in memory: 2 KiB for each 8 x 8 x 8 voxels that
/// were touched. Appears whole or not at all; throws InputError where it cannot be written.
void write_milled_bone(const std::filesystem::path& path, const MilledBone& milled);

/// Throws InputError, naming the file and the reason, for what `write_milled_bone` has not written whole.
MilledBone read_milled_bone(const std::filesystem::path& path);
/// The same without the bricks, which takes no time.
MilledBone read_milled_bone_facts(const std::filesystem::path& path);

}  // namespace osteomill
