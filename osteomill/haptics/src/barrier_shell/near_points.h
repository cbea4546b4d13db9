#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "barrier_shell/barrier.h"
#include "barrier_shell/cores.h"
#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// The points near one part of the tool as they were gathered, each coordinate in a row of its own: places in
/// T at that time, and the surface that each stands for.
struct NearPoints {
  /// Sums run in this number of lanes, whatever the width of the machine's registers, so they have the same
  /// bits everywhere.
  static constexpr std::size_t kLanes = 16;

  explicit NearPoints(std::size_t capacity);
  std::size_t capacity() const { return area.size(); }

  std::size_t count = 0;
  /// True if points found no room.
  bool overflowed = false;
  std::vector<float> x, y, z, area;
};

/// Near points as measured from one pose: the sum of their pushes and its derivatives by a move of the
/// tool, and for each point its distance to the part and the direction out of it. `x`, `y` and `z` hold the
/// places of points near the cylinder alone.
struct MeasuredPoints {
  explicit MeasuredPoints(std::size_t capacity);

  EnergySum sum;
  std::size_t count = 0;
  std::vector<float> distance, out_x, out_y, out_z, x, y, z;
  /// The points that are nearest to the cylinder's ends: the first `at_end_count` entries.
  std::vector<std::uint32_t> at_end;
  std::size_t at_end_count = 0;
};

/// A frame seen from another: `origin + turn p`.
struct Frame {
  float turn[3][3];
  float origin[3];
};
Frame frame_of(const Mat3& turn, const Vec3& origin_mm) noexcept;

/// Fills the last group of lanes with points far away, after the last brick.
void pad_last_lanes(NearPoints& near) noexcept;

/// Adds a point that pushes with `push` (energy, pressure and stiffness of all its area) at `point_T`,
/// `distance` from a core: one at a time, without vector instructions, for every part.
void add_point(EnergySum& sum, const Barrier::Value& push, const Vec3& point_T, const CoreDistance& distance);

/// Measures points from a tool that has moved since the gathering, so that its frame then is `moved` seen
/// from now. Gives the same bits whatever the width of the machine's registers. Safe in the haptic tick.
void measure_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                  MeasuredPoints& measured) noexcept;
void measure_cylinder(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                      MeasuredPoints& measured) noexcept;

}  // namespace osteomill::barrier_shell
