#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bone_points/cores.h"
#include "bone_points/energy_sum.h"

namespace osteomill {

/// The points near one part of the tool, each coordinate in a row of its own: places in T when they were
/// gathered, the surface each stands for; and, as of the last sum, the distance to the part, place and
/// direction out of it.
struct NearPoints {
  /// Sums run in so many lanes whatever the width of the machine's registers, and so have the same bits.
  static constexpr std::size_t kLanes = 16;

  explicit NearPoints(std::size_t capacity = 0);
  std::size_t room() const { return area.size(); }

  std::size_t count = 0;
  /// Whether points found no room.
  bool overflowed = false;
  std::vector<float> gathered_x, gathered_y, gathered_z, area;
  std::vector<float> x, y, z, distance, out_x, out_y, out_z;
  /// Of the points near the cylinder those that are nearest to its ends.
  std::vector<std::uint32_t> at_end;
  std::size_t at_end_count = 0;
};

/// A frame seen from another: `origin + turn p`.
struct Frame {
  float turn[3][3];
  float origin[3];
};
Frame frame_of(const Mat3& turn, const Vec3& origin_mm) noexcept;

/// After the last brick.
void close_gathering(NearPoints& near) noexcept;

/// What the points push with and its derivatives by a move of a tool that has moved since the gathering, so
/// that its frame then is `moved` seen from now. The same bits whatever the width of the machine's registers.
/// Safe in the haptic tick.
EnergySum ball_energy(NearPoints& near, const Frame& moved, const Cores& cores,
                      const Barrier& barrier) noexcept;
EnergySum cylinder_energy(NearPoints& near, const Frame& moved, const Cores& cores,
                          const Barrier& barrier) noexcept;

}  // namespace osteomill
