#pragma once

#include <cstddef>
#include <cstdint>

namespace osteomill {

/// Of neighbouring nodes along each axis, mm; its inverse; and what a crossing along it that is seen at right
/// angles stands for, mm^2.
struct CrossingSteps {
  float step[3], per_step[3], face[3];
};

/// A lattice as the kernel reads it: nodes that lie `next` floats apart along each axis.
struct CrossingLattice {
  std::ptrdiff_t next[3];
  float isovalue;
  CrossingSteps steps;
};

/// Eight nodes of a row and the edges that begin at them.
struct CrossingRow {
  static constexpr std::size_t kNodes = 8;
  /// The first node's density; those of all neighbours of the edges' ends lie about it.
  const float* densities;
  /// Where the first node lies, in steps.
  int i, j, k;
  /// For each axis, a bit a node: whether the surface crosses the edge along that axis.
  std::uint32_t crossed[3];
};

/// Sums over the crossings of a node's edges, by nodes: area times place (x, y, z, mm), area (mm^2), and area
/// times the surface's unit normal (x, y, z).
struct CrossingSums {
  static constexpr int kSums = 7;
  alignas(64) float rows[kSums][CrossingRow::kNodes];
};

/// In vector instructions chosen at run time, with the same bits from all of them. Safe in the haptic tick.
void add_crossings(const CrossingLattice& lattice, const CrossingRow& row, CrossingSums& sums);

/// For tests: the sets of vector instructions that this was compiled for, as Highway numbers them.
std::int64_t crossing_kernel_targets();

}  // namespace osteomill
