#pragma once

#include <cstdint>

#include "osteomill/haptics/bone_points/brick_points.h"

namespace osteomill::point_shell {

/// The tool and the penalty as the kernel reads them.
struct KernelTool {
  double burr_radius_mm;
  double shaft_radius_mm;
  double shaft_length_mm;
  /// Below this height on the axis a contact is the burr's.
  double burr_top_mm;
  double stiffness_N_per_mm3;
  double max_patch_mm2;
  /// How far outside the tool a point may still push.
  double reach_mm;
};

/// A brick's frame seen from the tool: `origin_mm + turn p`, the turn row by row.
struct KernelFrame {
  double turn[3][3];
  double origin_mm[3];
};

/// Sums over points, in eight lanes whatever the width of the machine's registers: slot n of a chunk goes to
/// lane n % 8. So the sums are the same to the last bit on every machine.
struct KernelSums {
  static constexpr int kLanes = 8;
  /// Points on the shaft's side, n = (u, w, 0): F u, F w, F z u, F z w, and k uu, k uw, k ww, each times 1,
  /// z, z^2.
  static constexpr int kSide = 13;
  /// Points on the burr: F n (3), and k n n^T (xx, xy, xz, yy, yz, zz).
  static constexpr int kSphere = 9;
  alignas(64) double side[kSide][kLanes] = {};
  alignas(64) double sphere[kSphere][kLanes] = {};
  int touching = 0;
};

/// Adds a chunk's points to the sums: those on the burr's sphere below `burr_top_mm` and those on the shaft's
/// side above it, which is nearly all. Returns the others that may touch (the ends, the axis), a bit each,
/// for the plain way. The widest vector instructions that the processor has are chosen when first called;
/// they give the same bits as the narrowest. Safe in the haptic tick.
std::uint32_t add_points(const PointChunk& chunk, const KernelFrame& frame, const KernelTool& tool,
                         KernelSums& sums);

/// The same for all chunks from `first_chunk` on, where it is known that every point is nearest to the
/// shaft's side, off its axis and above `burr_top_mm`, or does not touch.
void add_side_points(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                     const KernelTool& tool, KernelSums& sums);
/// Where every point is nearest to the burr's sphere, off its centre and below `burr_top_mm`, or does not
/// touch.
void add_sphere_points(const BrickPoints& points, std::uint32_t first_chunk, const KernelFrame& frame,
                       const KernelTool& tool, KernelSums& sums);

/// The sets of vector instructions that `add_points` was compiled for, as bits of hwy/targets.h.
std::int64_t kernel_targets();

}  // namespace osteomill::point_shell
