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

/// Finds where a ball overlaps voxels of one volume that are denser than a floor. It remembers, in bricks of
/// 8 x 8 x 8 voxels and a bit a voxel, which ones were empty at the last visit, so that a step costs little
/// more than what it finds: a burr in its hole has emptied the bricks around it. It finds pieces of rows (i
/// runs along a row), brick by brick.
class BurrReach {
 public:
  /// Allocates all that `find` needs. `volume` outlives it; from the first `find` on its densities must not
  /// rise. `max_radius_mm` is above 0, the grid not empty. No more than `max_pieces` are found at once.
  BurrReach(const Volume& volume, double max_radius_mm, float floor_density,
            std::size_t max_pieces = std::numeric_limits<std::size_t>::max());

  /// The rows that a step looks at if a ball has more voxels than a step has time for: those of every
  /// `count`-th line of the grid, shifted with `turn` so that `count` turns see all. `count` is a power of 2.
  struct Share {
    unsigned count = 1;
    unsigned turn = 0;
  };
  /// The voxels of a row within a brick, from `first` on, whose density is the first of `densities`: a bit
  /// for each that lies in the ball and may be denser than the floor.
  struct Piece {
    const float* densities;
    VoxelIndex first;
    std::uint8_t bits;
  };
  /// Finds what the ball overlaps, or a share of it. `centre_mm` (finite) is in the grid's axes, from the
  /// first voxel's centre; `radius_mm` at most the greatest. Safe in the haptic tick.
  void find(const Vec3& centre_mm, double radius_mm, const Share& share = {1, 0}) noexcept;
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Forgets voxels of a piece that hold nothing any more, so that they are not found again.
  void forget_voxels(const Piece& piece, unsigned gone) noexcept;
  float floor_density() const { return floor_density_; }
  /// Returns the most that can be found at once.
  std::size_t max_voxels() const { return max_voxels_; }
  std::size_t max_pieces() const { return max_pieces_; }

 private:
  static constexpr int kSide = BlockRanges::kBrickVoxels;
  /// A bit a voxel: whether it may be denser than the floor. Byte j + 8 k, bit i.
  using Bits = std::array<std::uint8_t, kSide * kSide>;
  /// Indices along one axis, both ends among them; none if last < first.
  struct Span {
    int first = 0;
    int last = -1;
  };
  /// Along one axis: the squared distance of each voxel's centre from the ball's, and the least of a brick's.
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
  // A bit a brick, 64 along a line of bricks to a word: whether it may hold voxels denser than the floor.
  std::size_t words_of_line_;
  std::vector<std::uint64_t> occupied_;
  std::vector<Bits> bits_;
  std::array<Squares, 3> squares_;

  std::vector<Piece> pieces_;
};

}  // namespace osteomill
