#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace osteomill::point_shell {

/// One bit a node of a grid: bone or not. Eight nodes of a row share a byte, and a layer of empty bytes lies
/// all about, so that neighbours can be read without a look at the border. Safe in the haptic tick.
class BoneBits {
 public:
  BoneBits() = default;
  /// No bone. Every dimension at least 1.
  explicit BoneBits(const std::array<int, 3>& dims)
      : row_bytes_((dims[0] + 7) / 8 + 2),
        rows_(dims[1] + 2),
        bytes_(static_cast<std::size_t>(row_bytes_) * static_cast<std::size_t>(rows_) *
               static_cast<std::size_t>(dims[2] + 2)) {}

  /// Nodes 8 * `byte` to 8 * `byte` + 7 of row j of slice k, the first in the lowest bit.
  std::uint8_t byte(int byte, int j, int k) const { return bytes_[index(byte, j, k)]; }
  void set_byte(int byte, int j, int k, std::uint8_t bits) { bytes_[index(byte, j, k)] = bits; }

  /// The nodes of that byte which are bone and have at least one of their 6 neighbours not bone.
  std::uint8_t surface_byte(int byte, int j, int k) const {
    const std::size_t here = index(byte, j, k);
    const std::size_t row = static_cast<std::size_t>(row_bytes_);
    const std::size_t slice = row * static_cast<std::size_t>(rows_);
    const unsigned bone = bytes_[here];
    const unsigned below = (bone << 1) | (bytes_[here - 1] >> 7);
    const unsigned above = (bone >> 1) | (static_cast<unsigned>(bytes_[here + 1]) << 7);
    const unsigned enclosed =
        below & above & bytes_[here - row] & bytes_[here + row] & bytes_[here - slice] & bytes_[here + slice];
    return static_cast<std::uint8_t>(bone & ~enclosed);
  }

 private:
  std::size_t index(int byte, int j, int k) const {
    return static_cast<std::size_t>(byte + 1) +
           static_cast<std::size_t>(row_bytes_) *
               (static_cast<std::size_t>(j + 1) +
                static_cast<std::size_t>(rows_) * static_cast<std::size_t>(k + 1));
  }

  int row_bytes_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace osteomill::point_shell
