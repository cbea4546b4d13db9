#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/base/row_major.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Finds the voxels that a ball overlaps and that are denser than a threshold, the floor. Caches empty voxels
/// in a bit mask of 8 x 8 x 8 bricks, so that the cost of a step is close to the number of voxels found: a
/// burr in its hole has already emptied the bricks around it. Results are pieces of rows (i runs along a
/// row), brick by brick.
class BurrReach {
 public:
  /// Allocates everything that `find` needs. `volume` must outlive this; from the first `find` on, its
  /// densities must not rise. `max_radius_mm` is above 0 and the grid not empty. One call of `find` returns
  /// at most `max_pieces`.
  BurrReach(const Volume& volume, double max_radius_mm, float floor_density,
            std::size_t max_pieces = std::numeric_limits<std::size_t>::max());

  /// Subset of rows processed in one step if the ball covers more voxels than the time budget allows: every
  /// `count`-th line of the grid, offset by `turn`, so that `count` consecutive turns cover all lines.
  /// `count` is a power of 2.
  struct Share {
    unsigned count = 1;
    unsigned turn = 0;
  };
  /// The part of a row that lies in one brick, beginning at voxel `first`, whose density is `densities[0]`.
  /// Bit n is set if voxel n is inside the ball and may be denser than the floor.
  struct Piece {
    const float* densities;
    VoxelIndex first;
    std::uint8_t bits;
  };
  /// Finds the pieces that the ball overlaps, or a share of them. `centre_mm` (finite) is in the grid's axes,
  /// relative to the first voxel's centre; `radius_mm` is at most `max_radius_mm`. Safe in the haptic tick.
  void find(const Vec3& centre_mm, double radius_mm, const Share& share = {1, 0}) noexcept;
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Marks voxels of a piece (bits `gone`) as empty, so that they are not found again.
  void forget_voxels(const Piece& piece, unsigned gone) noexcept;
  float floor_density() const { return floor_density_; }
  /// Returns the largest number of voxels that one `find` can return.
  std::size_t max_voxels() const { return max_voxels_; }
  std::size_t max_pieces() const { return max_pieces_; }

 private:
  static constexpr int kSide = BlockRanges::kBrickVoxels;
  /// One bit per voxel, set if it may be denser than the floor: byte j + 8 k, bit i.
  using Bits = std::array<std::uint8_t, kSide * kSide>;
  /// Inclusive index range along one axis; empty if last < first.
  struct Span {
    int first = 0;
    int last = -1;
  };
  /// Along one axis: squared distance of each voxel's centre from the ball's, and the minimum over each
  /// brick.
  struct Squares {
    Span voxels;
    Span bricks;
    std::vector<float> of_voxel_mm2;
    std::vector<double> of_brick_mm2;
  };

  void measure(Squares& squares, double centre_mm, std::size_t axis) const;
  std::uint64_t occupied_in_ball(int bj, int bk, std::size_t word, double left2_mm2);
  bool scan_brick(int bi, int bj, int bk);
  void find_pieces(std::size_t word, std::uint64_t occupied, int bj, int bk, const Share& share);
  std::size_t brick_line(int bj, int bk) const {
    return static_cast<std::size_t>(bj) +
           static_cast<std::size_t>(brick_dims_[1]) * static_cast<std::size_t>(bk);
  }
  std::size_t brick_index(int bi, int bj, int bk) const { return row_major(brick_dims_, bi, bj, bk); }

  const GridGeometry& geometry() const { return volume_->geometry(); }

  const Volume* volume_;
  double radius_mm_ = 0;
  std::size_t max_voxels_ = 0;
  std::size_t max_pieces_;
  float floor_density_;
  std::array<int, 3> brick_dims_;

  std::vector<bool> is_scanned_;
  // One bit per brick, 64 consecutive bricks of a line per word; set if the brick may hold voxels above the
  // floor.
  std::size_t words_of_line_;
  std::vector<std::uint64_t> occupied_;
  std::vector<Bits> bits_;
  std::array<Squares, 3> squares_;

  std::vector<Piece> pieces_;
};

}  // namespace osteomill
