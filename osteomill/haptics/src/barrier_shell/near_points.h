#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "barrier_shell/barrier.h"
#include "barrier_shell/cores.h"
#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// Gathered points near one part of the tool, as a structure of arrays: positions in T at the time of
/// gathering, and the area that each represents.
struct NearPoints {
  /// Number of accumulator lanes, independent of the register width, so that sums have the same bits on all
  /// machines.
  static constexpr std::size_t kLanes = 16;

  explicit NearPoints(std::size_t capacity);
  std::size_t capacity() const { return area.size(); }

  std::size_t count = 0;
  /// True if points were left out for lack of space.
  bool overflowed = false;
  std::vector<float> x, y, z, area;
};

/// Points measured at one pose: the sum of their energies and its derivatives with respect to tool motion,
/// and for each point its distance to the part and the outward direction. `x`, `y` and `z` are the positions,
/// for the cylinder only.
struct MeasuredPoints {
  explicit MeasuredPoints(std::size_t capacity);

  EnergySum sum;
  std::size_t count = 0;
  std::vector<float> distance, out_x, out_y, out_z, x, y, z;
  /// Indices of the points nearest to the cylinder's ends: the first `at_end_count` entries.
  std::vector<std::uint32_t> at_end;
  std::size_t at_end_count = 0;
};

/// Transform between frames: `origin + turn p`.
struct Frame {
  float turn[3][3];
  float origin[3];
};
Frame frame_of(const Mat3& turn, const Vec3& origin_mm) noexcept;

/// Pads the last group of lanes with distant points. Call after the last brick.
void pad_last_lanes(NearPoints& near) noexcept;

/// Adds a point at `point_T`, `distance` from a core, with `push` (energy, pressure and stiffness times its
/// area). Scalar code, for every part.
void add_point(EnergySum& sum, const Barrier::Value& push, const Vec3& point_T, const CoreDistance& distance);

/// Measures the points for a tool that has moved since they were gathered; `moved` maps T at the gathering to
/// T now. Gives the same bits for any register width. Safe in the haptic tick.
void measure_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                  MeasuredPoints& measured) noexcept;
void measure_cylinder(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                      MeasuredPoints& measured) noexcept;

}  // namespace osteomill::barrier_shell
