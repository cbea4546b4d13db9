#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bone_points/brick_points.h"

namespace osteomill {

/// A lattice as the kernel reads it. For each axis: stride between neighbouring nodes in floats, node spacing
/// (mm), its inverse, and the area (mm^2) represented by a crossing on an edge along that axis if the surface
/// is perpendicular to it.
struct CrossingLattice {
  std::ptrdiff_t next[3];
  float isovalue;
  float step[3], per_step[3], face[3];
};

/// A row of nodes and the edges that begin at them.
struct CrossingRow {
  static constexpr std::size_t kMaxNodes = 16;
  /// Number of nodes read at once.
  static constexpr std::size_t kNodes = 8;
  /// Density of the first node. The densities of all neighbours of the edges' ends must be readable too.
  const float* densities;
  /// Lattice position of the first node, in steps.
  int i, j, k;
  /// For each axis, one bit per node: set if the surface crosses the node's edge along that axis.
  std::uint32_t crossed[3];
};

/// Adds a point for each of a row's `cells` (one bit each) that has crossings: their area-weighted mean,
/// their total area, and the unit normal (zero if their normals cancel). `rows` are the node rows through the
/// row of cells; each cell has `group` nodes of every row: 1, or 2 to 8 of 16. Selects the SIMD target at run
/// time; all targets give the same bits. Safe in the haptic tick.
void add_means(const CrossingLattice& lattice, std::span<const CrossingRow> rows, int group,
               std::uint32_t cells, PointRows& points);

/// Returns a sphere around the first `count` points, centred in their bounding box. Its radius has a small
/// margin for rounding in all users. All SIMD targets give the same bits. Safe in the haptic tick.
BrickPoints::Bound bound_of(const PointRows& points, std::size_t count);

/// Selects the SIMD target, also for near_kernel.h. Otherwise the first call of a kernel does, which queries
/// the system.
void choose_point_instructions();

/// Returns the SIMD targets for which this was compiled, as Highway's bit mask. For tests.
std::int64_t brick_kernel_targets();

}  // namespace osteomill
