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

/// Densities of a scan, one float per voxel (Hounsfield units if the scan has them), in rows along i. Voxels
/// outside the grid have `outside_density()`. Copies share memory until they are changed (copy on write).
/// Reading is safe in the haptic tick; one thread writes. Made by `read_scan` and `builtin_tooth`.
class DensityGrid {
 public:
  DensityGrid() = default;
  /// `densities` has `geometry.voxel_count()` values, i fastest, all finite (the readers ensure that) or NaN
  /// for a voxel without density, which then gets the lowest of the others. Throws std::invalid_argument if
  /// the count differs or is 0, or no voxel has a density.
  DensityGrid(const GridGeometry& geometry, std::vector<float> densities);

  const GridGeometry& geometry() const { return geometry_; }
  /// Returns the densities in their memory layout, to be copied or compared as a whole.
  const CopyOnWriteFloats& densities() const { return densities_; }
  /// Returns the densities of row (j, k), from i = 0.
  std::span<const float> row(int j, int k) const noexcept {
    return {densities_.data() + offset_of(0, j, k), layout_.row_length};
  }
  /// Returns the address of the density of `v`, which must be in the grid. Neighbours along i are adjacent;
  /// along j and k they are row_stride() and slice_stride() floats apart. The 64 bytes after any density are
  /// readable.
  const float* address_of(const VoxelIndex& v) const noexcept {
    return densities_.data() + offset_of(v.i, v.j, v.k);
  }
  std::ptrdiff_t row_stride() const { return static_cast<std::ptrdiff_t>(layout_.row_stride); }
  std::ptrdiff_t slice_stride() const { return static_cast<std::ptrdiff_t>(layout_.slice_stride); }
  /// Returns whether the scan has a density for the voxel with this linear_index(). Statistics ignore voxels
  /// without one.
  bool has_density(std::size_t voxel) const { return !without_density_ || !(*without_density_)[voxel]; }
  std::size_t voxels_without_density() const { return voxels_without_density_; }
  /// Returns the lowest density the grid had when it was constructed.
  float outside_density() const { return outside_density_; }

  /// Returns the voxel's index, i fastest; not its offset in memory, which includes padding.
  std::size_t linear_index(const VoxelIndex& v) const noexcept {
    return row_major(geometry_.dims, v.i, v.j, v.k);
  }
  bool contains(const VoxelIndex& v) const noexcept {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < geometry_.dims[0] && v.j < geometry_.dims[1] &&
           v.k < geometry_.dims[2];
  }
  /// Returns the density of `v`, which must be in the grid.
  float operator[](const VoxelIndex& v) const { return *address_of(v); }
  /// Returns the density of `v`; outside_density() if it is not in the grid.
  float at_or_outside(const VoxelIndex& v) const noexcept {
    return contains(v) ? *address_of(v) : outside_density_;
  }
  /// Prefetches the voxel's cache line. `v` must be in the grid.
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
  /// Pre-faults the pages around `changed`, as far as a burr may move in some tens of milliseconds, so that
  /// the tick does not page-fault (CopyOnWriteFloats::prefault).
  void prefault_around(const VoxelBox& changed);

 private:
  std::size_t offset_of(int i, int j, int k) const {
    return static_cast<std::size_t>(i) + layout_.row_stride * static_cast<std::size_t>(j) +
           layout_.slice_stride * static_cast<std::size_t>(k);
  }

  GridGeometry geometry_;
  RowLayout layout_;
  // By linear index; null if every voxel has a density.
  std::shared_ptr<const std::vector<bool>> without_density_;
  std::size_t voxels_without_density_ = 0;
  CopyOnWriteFloats densities_;
  VoxelBox prefaulted_;
  float outside_density_ = 0;
};

/// Calls `use` with every row, a std::span<const float>, j fastest. Long work (WorkProgress).
template <typename Use>
void for_each_row(const DensityGrid& grid, const Use& use) {
  VoxelBox rows = grid.geometry().all_voxels();
  rows.last.i = 0;
  for_each_with_progress(rows, [&](const VoxelIndex& v) { use(grid.row(v.j, v.k)); });
}

/// Calls `use` with the density of every voxel that has one, in linear order. Long work.
template <typename Use>
void for_each_density(const DensityGrid& grid, const Use& use) {
  std::size_t voxel = 0;
  for_each_row(grid, [&](std::span<const float> row) {
    for (const float density : row) {
      if (grid.has_density(voxel++)) use(density);
    }
  });
}

/// Returns the densities of every `every`th voxel in linear order, without the voxels that have none.
std::vector<float> every_nth_density(const DensityGrid& grid, std::size_t every);

/// Returns one voxel's term of a hash that is the sum of all terms (modulo 2^64), so that it can be updated
/// from the changed voxels alone, in any order. Safe in the haptic tick.
inline std::uint64_t density_hash(std::size_t voxel, float density) noexcept {
  std::uint64_t x = (static_cast<std::uint64_t>(voxel) << 32) ^ std::bit_cast<std::uint32_t>(density);
  x *= 0x9e3779b97f4a7c15;
  x ^= x >> 29;
  x *= 0xbf58476d1ce4e5b9;
  return x ^ (x >> 32);
}

/// FNV-1a hash applied word by word, as fingerprint_of() applies it to a grid's densities.
class WordHash {
 public:
  void add(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

/// Returns a 64-bit hash that identifies a scan by its densities. Passes over the voxels; not for the tick.
std::uint64_t fingerprint_of(const DensityGrid& grid);

}  // namespace osteomill
