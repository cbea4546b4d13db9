#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "bone_points/brick_points.h"

namespace osteomill {

/// A lattice as the kernel reads it. For each axis: how many floats apart neighbouring nodes lie in memory,
/// their distance (mm), its inverse, and the area (mm^2) that a crossing of an edge along that axis stands
/// for if the surface is at right angles to the edge.
struct CrossingLattice {
  std::ptrdiff_t next[3];
  float isovalue;
  float step[3], per_step[3], face[3];
};

/// A row of nodes and the edges that begin at them.
struct CrossingRow {
  static constexpr std::size_t kMaxNodes = 16;
  /// The number of nodes that are read at once.
  static constexpr std::size_t kNodes = 8;
  /// The first node's density; those of all neighbours of the edges' ends lie about it.
  const float* densities;
  /// The place of the first node, in steps.
  int i, j, k;
  /// For each axis, a bit a node: whether the surface crosses the edge along that axis.
  std::uint32_t crossed[3];
};

/// Adds a point for each of a row's `cells`, a bit each, that has crossings: their mean by the area that each
/// stands for, that area, and the unit normal (zero if their normals are against one another). `rows` go
/// through the row of cells, each of which has `group` nodes of every row: 1, or 2 to 8 of 16. In vector
/// instructions chosen at run time, with the same bits from all of them. Safe in the haptic tick.
void add_means(const CrossingLattice& lattice, std::span<const CrossingRow> rows, int group,
               std::uint32_t cells, PointRows& points);

/// A sphere about the first `count` points: about the middle of their box, a hair wider than the farthest,
/// for the rounding of all who use it. The same bits from all instructions. Safe in the haptic tick.
BrickPoints::Bound bound_of(const PointRows& points, std::size_t count);

/// Chooses the instructions, also those of near_kernel.h. The first call of a kernel does that too, but asks
/// the system for it.
void choose_point_instructions();

/// Returns the sets of vector instructions for which this was compiled, as Highway numbers them. For tests.
std::int64_t brick_kernel_targets();

}  // namespace osteomill
