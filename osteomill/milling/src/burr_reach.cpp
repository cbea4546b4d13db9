#include "osteomill/milling/burr_reach.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "osteomill/base/bits_above.h"

namespace osteomill {

namespace {

// The cells of all voxels whose centres are in the ball lie in the ball grown by half a cell's diagonal.
std::size_t max_voxels_in_ball(const GridGeometry& geometry, double radius_mm) {
  const double grown_mm = radius_mm + 0.5 * geometry.spacing_mm.norm();
  const double max =
      4.0 / 3.0 * std::numbers::pi * grown_mm * grown_mm * grown_mm / geometry.voxel_volume_mm3();
  return static_cast<std::size_t>(std::min(max + 1, static_cast<double>(geometry.voxel_count())));
}

std::size_t max_across(const GridGeometry& geometry, double radius_mm, int axis) {
  const double across = 2 * radius_mm / geometry.spacing_mm[axis] + 2;
  const int dim = geometry.dims[static_cast<std::size_t>(axis)];
  return static_cast<std::size_t>(std::min(across, static_cast<double>(dim)));
}

std::size_t max_pieces_in_ball(const GridGeometry& geometry, double radius_mm) {
  const std::size_t lines = max_across(geometry, radius_mm, 1) * max_across(geometry, radius_mm, 2);
  return lines * (max_across(geometry, radius_mm, 0) / BlockRanges::kBrickVoxels + 2);
}

constexpr std::size_t kWordBits = 64;

std::size_t row_in_brick(int j, int k) {
  constexpr int kSide = BlockRanges::kBrickVoxels;
  return static_cast<std::size_t>(j % kSide + kSide * (k % kSide));
}

}  // namespace

BurrReach::BurrReach(const Volume& volume, double max_radius_mm, float floor_density, std::size_t max_pieces)
    : volume_(&volume),
      max_pieces_(std::min(max_pieces, max_pieces_in_ball(volume.geometry(), max_radius_mm))),
      floor_density_(floor_density),
      brick_dims_(volume.geometry().all_voxels().bricks(kSide).dims()) {
  max_voxels_ =
      std::min(max_voxels_in_ball(geometry(), max_radius_mm), static_cast<std::size_t>(kSide) * max_pieces_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    squares_[axis].of_voxel_mm2.resize(static_cast<std::size_t>(kSide * brick_dims_[axis]));
    squares_[axis].of_brick_mm2.resize(static_cast<std::size_t>(brick_dims_[axis]));
  }
  is_scanned_.resize(cell_count(brick_dims_));
  bits_.resize(cell_count(brick_dims_));
  words_of_line_ = (static_cast<std::size_t>(brick_dims_[0]) + kWordBits - 1) / kWordBits;
  occupied_.resize(words_of_line_ * brick_line(0, brick_dims_[2]), ~std::uint64_t{0});
  pieces_.reserve(max_pieces_);
}

void BurrReach::find(const Vec3& centre_mm, double radius_mm, const Share& share) noexcept {
  radius_mm_ = radius_mm;
  pieces_.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    measure(squares_[axis], centre_mm[static_cast<Eigen::Index>(axis)], axis);
  }
  const auto& [x, y, z] = squares_;
  if (x.bricks.last < x.bricks.first) return;
  const std::size_t first_word = static_cast<std::size_t>(x.bricks.first) / kWordBits;
  const std::size_t last_word = static_cast<std::size_t>(x.bricks.last) / kWordBits;
  for (int bk = z.bricks.first; bk <= z.bricks.last; ++bk) {
    for (int bj = y.bricks.first; bj <= y.bricks.last; ++bj) {
      const double left2 = radius_mm_ * radius_mm_ - z.of_brick_mm2[static_cast<std::size_t>(bk)] -
                           y.of_brick_mm2[static_cast<std::size_t>(bj)];
      if (left2 <= 0) continue;
      for (std::size_t word = first_word; word <= last_word; ++word) {
        const std::uint64_t occupied = occupied_in_ball(bj, bk, word, left2);
        if (occupied != 0) find_pieces(word, occupied, bj, bk, share);
      }
    }
  }
}

// Returns the mask of a word's bricks whose distance along the line is below sqrt(`left2_mm2`) and that may
// hold voxels above the floor.
std::uint64_t BurrReach::occupied_in_ball(int bj, int bk, std::size_t word, double left2_mm2) {
  const Squares& x = squares_[0];
  std::uint64_t& occupied = occupied_[words_of_line_ * brick_line(bj, bk) + word];
  const int base = static_cast<int>(kWordBits * word);
  const int from = std::max(0, x.bricks.first - base), to = std::min(63, x.bricks.last - base);
  std::uint64_t within = 0;
  for (std::uint64_t left = occupied & (~std::uint64_t{0} << from) & (~std::uint64_t{0} >> (63 - to));
       left != 0; left &= left - 1) {
    const int n = std::countr_zero(left), bi = base + n;
    if (x.of_brick_mm2[static_cast<std::size_t>(bi)] >= left2_mm2) continue;
    const std::uint64_t bit = std::uint64_t{1} << n;
    const std::size_t brick = brick_index(bi, bj, bk);
    if (!is_scanned_[brick]) {
      is_scanned_[brick] = true;
      if (!scan_brick(bi, bj, bk)) occupied &= ~bit;
    }
    within |= occupied & bit;
  }
  return within;
}

void BurrReach::measure(Squares& squares, double centre_mm, std::size_t axis) const {
  const double spacing = geometry().spacing_mm[static_cast<Eigen::Index>(axis)];
  const double count = geometry().dims[axis];
  // Clamped to the grid before the conversion to int: the centre may be anywhere.
  const double first = std::clamp((centre_mm - radius_mm_) / spacing, 0.0, count);
  const double last = std::clamp((centre_mm + radius_mm_) / spacing, -1.0, count - 1);
  squares.voxels = {static_cast<int>(std::ceil(first)), static_cast<int>(std::floor(last))};
  squares.bricks = {};
  if (squares.voxels.last < squares.voxels.first) return;
  squares.bricks = {squares.voxels.first / kSide, squares.voxels.last / kSide};
  for (int b = squares.bricks.first; b <= squares.bricks.last; ++b) {
    const int begin = kSide * b, end = std::min(begin + kSide, geometry().dims[axis]);
    double min = radius_mm_ * radius_mm_;
    for (int n = begin; n < begin + kSide; ++n) {
      const double away = n * spacing - centre_mm;
      squares.of_voxel_mm2[static_cast<std::size_t>(n)] = static_cast<float>(away * away);
      if (n < end) min = std::min(min, away * away);
    }
    squares.of_brick_mm2[static_cast<std::size_t>(b)] = min;
  }
}

// Scans a brick's voxels. Returns whether any is denser than the floor.
bool BurrReach::scan_brick(int bi, int bj, int bk) {
  if (!(volume_->ranges().at(bi, bj, bk).max > floor_density_)) return false;
  Bits& bits = bits_[brick_index(bi, bj, bk)];
  bits.fill(0);
  const auto& dims = geometry().dims;
  const int i = kSide * bi, columns = std::min(kSide, dims[0] - i);
  const int end_j = std::min(kSide, dims[1] - kSide * bj), end_k = std::min(kSide, dims[2] - kSide * bk);
  bool holds = false;
  for (int k = 0; k < end_k; ++k) {
    for (int j = 0; j < end_j; ++j) {
      const float* row = volume_->grid().address_of({i, kSide * bj + j, kSide * bk + k});
      unsigned byte = 0;
      for (int n = 0; n < columns; ++n) byte |= static_cast<unsigned>(row[n] > floor_density_) << n;
      bits[static_cast<std::size_t>(j + kSide * k)] = static_cast<std::uint8_t>(byte);
      holds = holds || byte != 0;
    }
  }
  return holds;
}

void BurrReach::find_pieces(std::size_t word, std::uint64_t occupied, int bj, int bk, const Share& share) {
  const auto& dims = geometry().dims;
  const DensityGrid& grid = volume_->grid();
  const auto& [x, y, z] = squares_;
  const int end_j = std::min(kSide * bj + kSide, dims[1]), end_k = std::min(kSide * bk + kSide, dims[2]);
  const int base = static_cast<int>(kWordBits * word);
  const Bits* bits = &bits_[brick_index(base, bj, bk)];
  for (int k = kSide * bk; k < end_k; ++k) {
    const double across_z =
        radius_mm_ * radius_mm_ - static_cast<double>(z.of_voxel_mm2[static_cast<std::size_t>(k)]);
    // The share consists of the lines for which j + 3 k - turn is a multiple of its count.
    const unsigned before = (share.turn - static_cast<unsigned>(kSide * bj + 3 * k)) & (share.count - 1);
    for (int j = kSide * bj + static_cast<int>(before); j < end_j; j += static_cast<int>(share.count)) {
      const double half2 = across_z - static_cast<double>(y.of_voxel_mm2[static_cast<std::size_t>(j)]);
      const std::size_t row = row_in_brick(j, k);
      for (std::uint64_t left = occupied; left != 0; left &= left - 1) {
        const int n = std::countr_zero(left), bi = base + n;
        const unsigned byte = bits[n][row];
        if (byte == 0 || x.of_brick_mm2[static_cast<std::size_t>(bi)] >= half2) continue;
        const float* squares = &x.of_voxel_mm2[static_cast<std::size_t>(kSide * bi)];
        const unsigned inside = byte & ~bits_above(squares, kSide, static_cast<float>(half2));
        if (inside == 0) continue;
        if (pieces_.size() == max_pieces_) return;
        const VoxelIndex first{kSide * bi, j, k};
        pieces_.push_back({grid.address_of(first), first, static_cast<std::uint8_t>(inside)});
        // Each row is in a different cache line; the first are loaded by the time all pieces are found.
        grid.prefetch(first);
      }
    }
  }
}

void BurrReach::forget_voxels(const Piece& piece, unsigned gone) noexcept {
  const VoxelIndex& first = piece.first;
  const int bi = first.i / kSide, bj = first.j / kSide, bk = first.k / kSide;
  Bits& bits = bits_[brick_index(bi, bj, bk)];
  std::uint8_t& byte = bits[row_in_brick(first.j, first.k)];
  byte = static_cast<std::uint8_t>(byte & ~gone);
  if (byte != 0 || bits != Bits{}) return;
  const std::size_t word = static_cast<std::size_t>(bi) / kWordBits;
  occupied_[words_of_line_ * brick_line(bj, bk) + word] &=
      ~(std::uint64_t{1} << (static_cast<std::size_t>(bi) % kWordBits));
}

}  // namespace osteomill
