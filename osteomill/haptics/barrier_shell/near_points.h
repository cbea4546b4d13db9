#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/haptics/barrier_shell/barrier.h"
#include "osteomill/haptics/barrier_shell/certificate.h"
#include "osteomill/haptics/barrier_shell/energy_sum.h"
#include "osteomill/haptics/bone_points/brick_points.h"

namespace osteomill::barrier_shell {

/// The points near one core, each coordinate in a row of its own: places in T when they were gathered, the
/// surface each stands for, and, as of the last sum, place, distance to the core and direction out of it.
struct NearPoints {
  /// Sums run in so many lanes whatever the width of the machine's registers, and so have the same bits.
  static constexpr std::size_t kLanes = 16;

  explicit NearPoints(std::size_t capacity = 0);
  std::size_t capacity() const { return capacity_; }

  std::size_t count = 0;
  /// Whether points found no room.
  bool overflowed = false;
  std::vector<float> gathered_x, gathered_y, gathered_z, area;
  std::vector<float> x, y, z, distance, out_x, out_y, out_z;
  /// Of the points near the cylinder those that lie beyond its ends.
  std::vector<std::uint32_t> beyond_end;

 private:
  std::size_t capacity_ = 0;
};

/// A frame seen from another: `origin + turn p`.
struct Frame {
  float turn[3][3];
  float origin[3];
};
Frame frame_of(const Mat3& turn, const Vec3& origin_mm);

/// How far from a core points are gathered: `near_mm` + `per_lever` times their distance from the burr's
/// centre.
struct Reach {
  double near_mm = 0;
  double per_lever = 0;
};

/// Appends the points of a brick that are within reach of the core; `frame` is the brick's, seen from the
/// tool. The widest vector instructions that the processor has are chosen when first called; they give the
/// same bits as the narrowest, as do those of all that follows. Safe in the haptic tick.
void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const Cores& cores, const Reach& reach, NearPoints& near);
void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const Cores& cores, const Reach& reach, NearPoints& near);
/// After the last brick.
void close_gathering(NearPoints& near);

/// The barrier's energy and its derivatives by a move of the tool that has moved since the gathering, so that
/// the tool's frame then is `moved` seen from now.
EnergySum ball_energy(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier);
EnergySum cylinder_energy(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier);

/// The greatest `distance_used / distance` of a move, at the distances of the last sum; at least 0.
double max_use_by_ball(const NearPoints& near, const MoveT& move, const Barrier& barrier);
double max_use_by_cylinder(const NearPoints& near, const MoveT& move, const Barrier& barrier);

/// The sets of vector instructions that this was compiled for, as bits of hwy/targets.h.
std::int64_t compiled_targets();

}  // namespace osteomill::barrier_shell
