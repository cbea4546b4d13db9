#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace osteomill {

class DensityGrid;

/// One voxel's part in a hash that is the sum of all parts (modulo 2^64), so that it follows a change at the
/// cost of what changes, in any order. Safe in the haptic tick.
inline std::uint64_t density_hash(std::size_t voxel, float density) {
  std::uint64_t x = (static_cast<std::uint64_t>(voxel) << 32) ^ std::bit_cast<std::uint32_t>(density);
  x *= 0x9e3779b97f4a7c15;
  x ^= x >> 29;
  x *= 0xbf58476d1ce4e5b9;
  return x ^ (x >> 32);
}

/// FNV-1a, a word at a time.
class WordHash {
 public:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// A number that two scans hardly share. Goes through every voxel; not for the tick.
std::uint64_t fingerprint_of(const DensityGrid& grid);

}  // namespace osteomill
