#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/copy_on_write_floats.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// The densities of a scan, one float a voxel (Hounsfield units if the scan has them), in rows along i.
/// Outside the grid there is nothing: every voxel there counts as `outside_density()`. Copies share the
/// memory of all that was changed in none of them. Reading is safe in the haptic tick; one thread writes.
/// `read_scan` and `builtin_tooth` make one.
class DensityGrid {
 public:
  DensityGrid() = default;
  /// `densities` has `geometry.voxel_count()` values, i running fastest, all finite (the readers see to
  /// that) or NaN if the scan has none for a voxel, which then gets the least of the others. Throws
  /// std::invalid_argument if the count differs or is 0, or no voxel has a density.
  DensityGrid(const GridGeometry& geometry, std::vector<float> densities);

  const GridGeometry& geometry() const { return geometry_; }
  /// Returns the densities as they lie in memory, to be kept and compared.
  const CopyOnWriteFloats& densities() const { return densities_; }
  /// Returns the densities of row (j, k), from i = 0.
  std::span<const float> row(int j, int k) const noexcept {
    return {densities_.data() + offset_of(0, j, k), layout_.row_length};
  }
  /// Returns the address of the density of `v`, which must be in the grid. Those that follow along i lie
  /// behind it; along j and k the next are row_stride() and slice_stride() floats on. 64 bytes behind any may
  /// be read.
  const float* address_of(const VoxelIndex& v) const noexcept {
    return densities_.data() + offset_of(v.i, v.j, v.k);
  }
  std::ptrdiff_t row_stride() const { return static_cast<std::ptrdiff_t>(layout_.row_stride); }
  std::ptrdiff_t slice_stride() const { return static_cast<std::ptrdiff_t>(layout_.slice_stride); }
  /// Returns whether the scan has a density for a voxel, by its number (linear_index()). A voxel without one
  /// counts in no statistics.
  bool has_density(std::size_t voxel) const { return !without_density_ || !(*without_density_)[voxel]; }
  std::size_t voxels_without_density() const { return voxels_without_density_; }
  /// Returns the least density of the grid as it was made.
  float outside_density() const { return outside_density_; }

  /// Returns the voxel's number, i running fastest: not its offset in memory.
  std::size_t linear_index(const VoxelIndex& v) const noexcept {
    return row_major(geometry_.dims, v.i, v.j, v.k);
  }
  bool contains(const VoxelIndex& v) const noexcept {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < geometry_.dims[0] && v.j < geometry_.dims[1] &&
           v.k < geometry_.dims[2];
  }
  /// Returns the density of `v`, which must lie in the grid.
  float operator[](const VoxelIndex& v) const { return *address_of(v); }
  /// Returns the density of any `v`; the outside density beyond the border.
  float at_or_outside(const VoxelIndex& v) const noexcept {
    return contains(v) ? *address_of(v) : outside_density_;
  }
  /// Asks for the voxel's cache line ahead of reading it. `v` must lie in the grid.
  void prefetch(const VoxelIndex& v) const {
#ifdef __GNUC__
    __builtin_prefetch(address_of(v));
#else
    (void)v;
#endif
  }
  void set(const VoxelIndex& v, float density) noexcept {
    densities_.set(offset_of(v.i, v.j, v.k), density);
  }
  /// Pre-faults the pages around `changed`, so that the tick does not page-fault
  /// (CopyOnWriteFloats::prepare), as far as a burr may go on from there in some tens of milliseconds.
  void prefault_around(const VoxelBox& changed);

 private:
  std::size_t offset_of(int i, int j, int k) const {
    return static_cast<std::size_t>(i) + layout_.row_stride * static_cast<std::size_t>(j) +
           layout_.slice_stride * static_cast<std::size_t>(k);
  }

  GridGeometry geometry_;
  RowLayout layout_;
  // By number; null if every voxel has a density.
  std::shared_ptr<const std::vector<bool>> without_density_;
  std::size_t voxels_without_density_ = 0;
  CopyOnWriteFloats densities_;
  VoxelBox prefaulted_;
  float outside_density_ = 0;
};

/// Calls `use` with every row, a std::span<const float>, j running fastest. Long work (WorkProgress).
template <typename Use>
void for_each_row(const DensityGrid& grid, const Use& use) {
  VoxelBox rows = grid.geometry().all_voxels();
  rows.last.i = 0;
  for_each_with_progress(rows, [&](const VoxelIndex& v) { use(grid.row(v.j, v.k)); });
}

/// Calls `use` with the density of every voxel that has one, in the order of their numbers. Long work.
template <typename Use>
void for_each_density(const DensityGrid& grid, const Use& use) {
  std::size_t voxel = 0;
  for_each_row(grid, [&](std::span<const float> row) {
    for (const float density : row) {
      if (grid.has_density(voxel++)) use(density);
    }
  });
}

/// Returns the densities of every `every`th voxel, in the order of their numbers, without the voxels that
/// have none.
std::vector<float> every_nth_density(const DensityGrid& grid, std::size_t every);

/// Returns one voxel's part in a hash that is the sum of all parts (modulo 2^64): after a change, in any
/// order, only the parts of the changed voxels are computed again. Safe in the haptic tick.
inline std::uint64_t density_hash(std::size_t voxel, float density) noexcept {
  std::uint64_t x = (static_cast<std::uint64_t>(voxel) << 32) ^ std::bit_cast<std::uint32_t>(density);
  x *= 0x9e3779b97f4a7c15;
  x ^= x >> 29;
  x *= 0xbf58476d1ce4e5b9;
  return x ^ (x >> 32);
}

/// Hashes words by FNV-1a, a word at a time, as fingerprint_of() does with a grid's densities.
class WordHash {
 public:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Returns a number that two scans hardly share. Goes through every voxel; not for the tick.
std::uint64_t fingerprint_of(const DensityGrid& grid);

}  // namespace osteomill
