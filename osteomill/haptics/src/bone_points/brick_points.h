#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "osteomill/base/pose.h"

namespace osteomill {

/// A point of the shell: its position in its brick's frame (mm), the surface area that it represents (mm^2),
/// and the outward unit normal in the grid's axes (zero if unknown).
struct ShellPoint {
  float x_mm;
  float y_mm;
  float z_mm;
  float area_mm2;
  float normal_x = 0;
  float normal_y = 0;
  float normal_z = 0;

  Vec3 position_mm() const {
    return {static_cast<double>(x_mm), static_cast<double>(y_mm), static_cast<double>(z_mm)};
  }
  Vec3 normal() const {
    return {static_cast<double>(normal_x), static_cast<double>(normal_y), static_cast<double>(normal_z)};
  }
  friend bool operator==(const ShellPoint&, const ShellPoint&) = default;
};

/// Up to 32 points of one brick, as a structure of arrays. Empty slots hold a distant point without area, so
/// that all 32 can be processed alike.
struct PointChunk {
  static constexpr std::size_t kSlots = 32;
  static constexpr float kFarAway_mm = 1e6f;
  alignas(64) std::array<float, kSlots> x_mm;
  alignas(64) std::array<float, kSlots> y_mm;
  alignas(64) std::array<float, kSlots> z_mm;
  alignas(64) std::array<float, kSlots> area_mm2;

  /// Returns a point; its normal is not stored.
  ShellPoint point(std::size_t slot) const { return {x_mm[slot], y_mm[slot], z_mm[slot], area_mm2[slot]}; }
  void clear(std::size_t slot) {
    x_mm[slot] = y_mm[slot] = z_mm[slot] = kFarAway_mm;
    area_mm2[slot] = 0;
  }
};

/// Points of a brick before they are stored, as a structure of arrays with capacity for `most` points and
/// padding for whole SIMD vectors.
struct PointRows {
  /// Capacity 0.
  PointRows() = default;
  explicit PointRows(std::size_t most);

  std::size_t count = 0;
  std::vector<float> x_mm, y_mm, z_mm, area_mm2, normal_x, normal_y, normal_z;

  void add(const ShellPoint& point) {
    const std::size_t n = count++;
    x_mm[n] = point.x_mm;
    y_mm[n] = point.y_mm;
    z_mm[n] = point.z_mm;
    area_mm2[n] = point.area_mm2;
    normal_x[n] = point.normal_x;
    normal_y[n] = point.normal_y;
    normal_z[n] = point.normal_z;
  }
  ShellPoint point(std::size_t n) const {
    return {x_mm[n], y_mm[n], z_mm[n], area_mm2[n], normal_x[n], normal_y[n], normal_z[n]};
  }
};

/// The points of all bricks, in chunks from one preallocated pool. Reading and writing are safe in the haptic
/// tick, for one writing thread. An exhausted pool drops points and counts them.
class BrickPoints {
 public:
  static constexpr std::uint32_t kNoChunk = std::numeric_limits<std::uint32_t>::max();

  /// Bounding sphere of a brick's points, in the brick's frame.
  struct Bound {
    std::array<float, 3> centre_mm{0, 0, 0};
    float radius_mm = 0;

    Vec3 centre() const {
      return {static_cast<double>(centre_mm[0]), static_cast<double>(centre_mm[1]),
              static_cast<double>(centre_mm[2])};
    }
  };
  struct Brick {
    std::uint32_t first_chunk = kNoChunk;
    std::uint32_t count = 0;
    Bound bound;
  };

  BrickPoints() = default;
  BrickPoints(std::size_t brick_count, std::size_t chunk_capacity);

  const Brick& brick(std::size_t index) const { return bricks_[index]; }
  const PointChunk& chunk(std::uint32_t index) const { return chunks_[index]; }
  std::uint32_t next_chunk(std::uint32_t index) const { return next_[index]; }
  std::size_t free_chunks() const { return free_chunks_; }
  /// Returns the total number of points.
  std::size_t total() const { return total_; }
  /// Returns the number of points dropped since the start.
  std::uint64_t dropped() const { return dropped_; }

  /// Replaces the brick's points. Returns how many were stored.
  std::uint32_t replace(std::size_t brick, const PointRows& points);
  /// Calls `f(point)` for each of the brick's points, in order.
  template <typename F>
  void for_each_of(std::size_t brick, F&& f) const {
    std::uint32_t left = bricks_[brick].count;
    for (std::uint32_t c = bricks_[brick].first_chunk; left > 0; c = next_[c]) {
      for (std::size_t slot = 0; slot < PointChunk::kSlots && left > 0; ++slot, --left) {
        f(chunks_[c].point(slot));
      }
    }
  }

 private:
  std::uint32_t take_chunk();
  void set_chunk_count(Brick& brick, std::size_t wanted);

  std::vector<PointChunk> chunks_;
  std::vector<std::uint32_t> next_;
  std::vector<Brick> bricks_;
  std::uint32_t first_free_ = kNoChunk;
  std::size_t free_chunks_ = 0;
  std::size_t total_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace osteomill
