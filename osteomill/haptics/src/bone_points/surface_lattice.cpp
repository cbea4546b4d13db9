#include "bone_points/surface_lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "osteomill/base/bits_above.h"

namespace osteomill {

namespace {

// Points are merged if their mean normal is longer than this, so that they nearly lie in a plane.
constexpr float kFlat = 0.98f;

// Largest number of voxels that are sampled individually if the block ranges are inconclusive, and of ranges
// that are sampled in a large box.
constexpr std::size_t kMaxSampledVoxels = 6 * 6 * 6;
constexpr std::size_t kMaxSampledRanges = 5 * 5 * 5;

// Accumulates whether any density is bone, and whether all are.
struct Coverage {
  bool any_bone = false;
  bool all_bone = true;

  void add(bool any, bool all) {
    any_bone |= any;
    all_bone &= all;
  }
  SurfaceLattice::Occupancy occupancy() const {
    if (!any_bone) return SurfaceLattice::Occupancy::no_bone;
    return all_bone ? SurfaceLattice::Occupancy::all_bone : SurfaceLattice::Occupancy::surface;
  }
};

int floor_divide(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

// Area-weighted mean of points. The more the surface bends, the shorter the mean normal.
class Mean {
 public:
  void add(const ShellPoint& point) {
    sum_.x_mm += point.area_mm2 * point.x_mm;
    sum_.y_mm += point.area_mm2 * point.y_mm;
    sum_.z_mm += point.area_mm2 * point.z_mm;
    sum_.area_mm2 += point.area_mm2;
    sum_.normal_x += point.area_mm2 * point.normal_x;
    sum_.normal_y += point.area_mm2 * point.normal_y;
    sum_.normal_z += point.area_mm2 * point.normal_z;
  }
  bool is_empty() const { return !(sum_.area_mm2 > 0); }
  ShellPoint mean() const {
    const float share = 1 / sum_.area_mm2;
    return {share * sum_.x_mm,     share * sum_.y_mm,     share * sum_.z_mm,    sum_.area_mm2,
            share * sum_.normal_x, share * sum_.normal_y, share * sum_.normal_z};
  }

 private:
  ShellPoint sum_{0, 0, 0, 0};
};

bool is_flat(const ShellPoint& mean) {
  return mean.normal_x * mean.normal_x + mean.normal_y * mean.normal_y + mean.normal_z * mean.normal_z >
         kFlat * kFlat;
}

}  // namespace

SurfaceLattice::SurfaceLattice(const Volume& volume, double spacing_mm) : volume_(&volume) {
  const GridGeometry& geometry = volume.geometry();
  const double voxel_mm = geometry.spacing_mm.maxCoeff();
  constexpr double kRounding = 1e-9;
  // A brick of 16 nodes holds two cells of eight a side.
  while (group_ < kMaxGroup && 2 * group_ * voxel_mm <= spacing_mm * (1 + kRounding)) group_ *= 2;
  line_step_ = std::max(1, group_ / 2);
  line_nodes_ = 0;
  for (int n = 0; n < 32; n += line_step_) line_nodes_ |= 1u << n;
  brick_nodes_ = group_ == 1 ? 8 : kMaxBrickNodes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double& step_mm = step_mm_[static_cast<Eigen::Index>(axis)];
    step_mm = geometry.spacing_mm[static_cast<Eigen::Index>(axis)];
    int& steps = steps_per_voxel_[axis];
    steps = std::max(1, static_cast<int>(std::ceil(step_mm / spacing_mm - kRounding)));
    step_mm /= steps;
    const int nodes = (geometry.dims[axis] - 1) * steps + 1;
    brick_dims_[axis] = (nodes + brick_nodes_) / brick_nodes_;
  }
  brick_radius_mm_ = 0.5 * brick_nodes_ * step_mm_.norm();
  crossings_.isovalue = largest_float_up_to(volume.isovalue());
  outside_ = std::min(volume.grid().outside_density(), crossings_.isovalue - 1);
  for (int axis = 0; axis < 3; ++axis) {
    crossings_.step[axis] = static_cast<float>(step_mm_[axis]);
    crossings_.per_step[axis] = static_cast<float>(1 / step_mm_[axis]);
    crossings_.face[axis] = static_cast<float>(line_step_ * line_step_ * step_mm_.prod() / step_mm_[axis]);
  }
}

float SurfaceLattice::density(const VoxelIndex& voxel) const {
  return volume_->grid().contains(voxel) ? volume_->grid()[voxel] : outside_;
}

// Returns the voxels on which the nodes at the ends of the edges in `node` depend, plus those of `more_nodes`
// further nodes on every side; the box may extend beyond the grid.
VoxelBox SurfaceLattice::voxels_of(int level, const VoxelIndex& node, int more_nodes) const {
  const int n = brick_nodes_ << level;
  const auto& s = steps_per_voxel_;
  const auto first = [&](int b, std::size_t axis) { return floor_divide(n * b - 1 - more_nodes, s[axis]); };
  const auto last = [&](int b, std::size_t axis) {
    return floor_divide(n * b + n - 2 + more_nodes, s[axis]) + 1;
  };
  return {{first(node.i, 0), first(node.j, 1), first(node.k, 2)},
          {last(node.i, 0), last(node.j, 1), last(node.k, 2)}};
}

// Includes one more node all round, on which the weights of crossings depend.
std::uint32_t SurfaceLattice::changes_of(const VoxelIndex& brick) const {
  return volume_->ranges().changes_in(voxels_of(0, brick, 1).intersected(volume_->geometry().all_voxels()));
}

SurfaceLattice::Occupancy SurfaceLattice::occupancy_of(int level, const VoxelIndex& node) const {
  const VoxelBox voxels = voxels_of(level, node, 0);
  const VoxelBox inside = voxels.intersected(volume_->geometry().all_voxels());
  if (inside.empty()) return Occupancy::no_bone;
  const Coverage none{false, inside == voxels};
  const VoxelBox ranges = inside.bricks(BlockRanges::kBrickVoxels);
  if (cell_count(ranges.dims()) > kMaxSampledRanges) return Occupancy::surface;
  Coverage coverage = none;
  for_each(ranges, [&](const VoxelIndex& at) {
    const BlockRanges::Range& range = volume_->ranges().at(at);
    coverage.add(range.max > crossings_.isovalue, range.min > crossings_.isovalue);
  });
  if (coverage.occupancy() != Occupancy::surface || cell_count(inside.dims()) > kMaxSampledVoxels)
    return coverage.occupancy();
  coverage = none;
  for_each(inside, [&](const VoxelIndex& at) {
    const bool bone = volume_->grid()[at] > crossings_.isovalue;
    coverage.add(bone, bone);
  });
  return coverage.occupancy();
}

VoxelBox SurfaceLattice::bricks_touched_by(const VoxelBox& voxels) const {
  if (voxels.empty()) return voxels;
  const int n = brick_nodes_;
  const auto& s = steps_per_voxel_;
  // A node depends on voxels less than one voxel away. A crossing's weight depends on nodes from one below
  // the edge's lower node to two above it. The lowest edges of a brick begin one node below its own.
  const auto first_node = [&](int v, std::size_t axis) { return (v - 1) * s[axis] + 1; };
  const auto last_node = [&](int v, std::size_t axis) { return (v + 1) * s[axis] - 1; };
  const auto brick_of_edge = [&](int lower_node) { return floor_divide(lower_node + 1, n); };
  const auto first = [&](int v, std::size_t axis) {
    return std::max(0, brick_of_edge(first_node(v, axis) - 2));
  };
  const auto last = [&](int v, std::size_t axis) {
    return std::min(brick_dims_[axis] - 1, brick_of_edge(last_node(v, axis) + 1));
  };
  return {{first(voxels.first.i, 0), first(voxels.first.j, 1), first(voxels.first.k, 2)},
          {last(voxels.last.i, 0), last(voxels.last.j, 1), last(voxels.last.k, 2)}};
}

// Returns the scan itself if possible, else `block`, which it fills.
SurfaceLattice::Nodes SurfaceLattice::nodes_of(const VoxelIndex& brick, Block& block) const {
  const DensityGrid& grid = volume_->grid();
  // The first node is one below the brick's, and gradients need one more.
  const VoxelIndex first{brick_nodes_ * brick.i - 2, brick_nodes_ * brick.j - 2, brick_nodes_ * brick.k - 2};
  const int last = brick_nodes_ + 2;
  // The kernel reads whole rows of eight.
  const bool inside =
      grid.contains(first) &&
      grid.contains({first.i + last + static_cast<int>(CrossingRow::kNodes), first.j + last, first.k + last});
  const bool at_voxels = steps_per_voxel_ == std::array{1, 1, 1};
  if (at_voxels && inside) {
    return {grid.address_of({first.i + 1, first.j + 1, first.k + 1}),
            {1, grid.row_stride(), grid.slice_stride()}};
  }
  if (at_voxels) {
    copy_voxels(first, block);
  } else {
    interpolate_voxels(first, block);
  }
  return {&block[1 + kRow + kSlice], {1, kRow, kSlice}};
}

void SurfaceLattice::copy_voxels(const VoxelIndex& first, Block& block) const {
  const int count = brick_nodes_ + 3;
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) {
      float* row = &block[static_cast<std::size_t>(k) * kSlice + static_cast<std::size_t>(j) * kRow];
      for (int i = 0; i < count; ++i) row[i] = density({first.i + i, first.j + j, first.k + k});
    }
  }
}

// Trilinear, axis by axis. No voxel has a negative weight, so a node's density never rises when its voxels'
// fall.
void SurfaceLattice::interpolate_voxels(const VoxelIndex& first, Block& block) const {
  const int count = brick_nodes_ + 3;
  const auto& s = steps_per_voxel_;
  const VoxelIndex from{floor_divide(first.i, s[0]), floor_divide(first.j, s[1]),
                        floor_divide(first.k, s[2])};
  struct CellPosition {
    std::size_t cell;
    float fraction;
  };
  std::array<std::array<CellPosition, kMaxBlockNodes>, 3> positions;
  const std::array<int, 3> nodes{first.i, first.j, first.k}, voxels{from.i, from.j, from.k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float per_step = 1.0f / static_cast<float>(s[axis]);
    for (int n = 0; n < count; ++n) {
      const int cell = floor_divide(nodes[axis] + n, s[axis]);
      positions[axis][static_cast<std::size_t>(n)] = {
          static_cast<std::size_t>(cell - voxels[axis]),
          per_step * static_cast<float>(nodes[axis] + n - s[axis] * cell)};
    }
  }
  const std::size_t n = static_cast<std::size_t>(count);
  const auto needed = [&](std::size_t axis) { return positions[axis][n - 1].cell + 2; };
  const auto between = [](float a, float b, float fraction) { return a + fraction * (b - a); };
  std::array<float, kSlice> rows;           // one slice of voxels, its rows interpolated
  std::array<float, kSlice * kRow> slices;  // nodes in i and j, voxels in k
  for (std::size_t k = 0; k < needed(2); ++k) {
    for (std::size_t j = 0; j < needed(1); ++j) {
      std::array<float, kRow + 1> row;
      for (std::size_t i = 0; i < needed(0); ++i) {
        row[i] = density(
            {from.i + static_cast<int>(i), from.j + static_cast<int>(j), from.k + static_cast<int>(k)});
      }
      for (std::size_t i = 0; i < n; ++i) {
        const CellPosition& p = positions[0][i];
        rows[j * kRow + i] = between(row[p.cell], row[p.cell + 1], p.fraction);
      }
    }
    for (std::size_t j = 0; j < n; ++j) {
      const CellPosition& p = positions[1][j];
      for (std::size_t i = 0; i < n; ++i) {
        slices[k * kSlice + j * kRow + i] =
            between(rows[p.cell * kRow + i], rows[(p.cell + 1) * kRow + i], p.fraction);
      }
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    const CellPosition& p = positions[2][k];
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = j * kRow + i;
        block[k * kSlice + at] =
            between(slices[p.cell * kSlice + at], slices[(p.cell + 1) * kSlice + at], p.fraction);
      }
    }
  }
}

SurfaceLattice::Occupancy SurfaceLattice::find_surface(const VoxelIndex& brick, RowBits& empty_rows,
                                                       BrickSurface& surface) const {
  surface.fine.count = surface.coarse.count = 0;
  Block block;
  const Nodes nodes = nodes_of(brick, block);
  Rows rows{};
  const Occupancy occupancy = find_bone(nodes, find_solid_rows(brick), empty_rows, rows);
  if (occupancy == Occupancy::surface) add_cell_means(nodes, rows, surface);
  return occupancy;
}

// Returns the rows that are solid bone by the ranges of densities, if nodes are voxels.
SurfaceLattice::RowBits SurfaceLattice::find_solid_rows(const VoxelIndex& brick) const {
  RowBits rows{};
  const VoxelBox voxels = voxels_of(0, brick, 0);
  if (steps_per_voxel_ != std::array{1, 1, 1} ||
      voxels.intersected(volume_->geometry().all_voxels()) != voxels) {
    return rows;
  }
  constexpr int kSide = BlockRanges::kBrickVoxels;
  const VoxelBox blocks = voxels.bricks(kSide);
  const auto rows_of_block = [&](int bj) {
    const int first = std::max(0, bj * kSide - voxels.first.j);
    const int end = std::min(brick_nodes_ + 1, (bj + 1) * kSide - voxels.first.j);
    return (1u << end) - (1u << first);
  };
  for (int k = 0; k <= brick_nodes_; ++k) {
    const int bk = (voxels.first.k + k) / kSide;
    std::uint32_t& of_slice = rows[static_cast<std::size_t>(k)];
    if (k > 0 && bk == (voxels.first.k + k - 1) / kSide) {
      of_slice = rows[static_cast<std::size_t>(k) - 1];
      continue;
    }
    for (int bj = blocks.first.j; bj <= blocks.last.j; ++bj) {
      bool bone = true;
      for (int bi = blocks.first.i; bi <= blocks.last.i; ++bi) {
        bone = bone && volume_->ranges().at(bi, bj, bk).min > crossings_.isovalue;
      }
      if (bone) of_slice |= rows_of_block(bj);
    }
  }
  return rows;
}

// Visits only rows that contain lines. Memory access dominates, with a cache line or two per row, so all rows
// to be read are prefetched first.
SurfaceLattice::Occupancy SurfaceLattice::find_bone(const Nodes& nodes, const RowBits& solid_rows,
                                                    RowBits& empty_rows, Rows& rows) const {
  const std::uint32_t whole = (2u << brick_nodes_) - 1;
  const auto for_each_row = [&](const auto& wanted, const auto& use) {
    for (int k = 0; k <= brick_nodes_; ++k) {
      const auto at = static_cast<std::size_t>(k);
      const std::uint32_t lines = is_on_line(k) ? whole : whole & line_nodes_;
      for (std::uint32_t left = lines & wanted(at); left != 0; left &= left - 1)
        use(std::countr_zero(left), k);
    }
  };
  const auto unknown = [&](std::size_t k) { return ~(solid_rows[k] | empty_rows[k]); };
  for_each_row(unknown, [&](int j, int k) {
    __builtin_prefetch(nodes.at(0, j, k));
    __builtin_prefetch(nodes.at(brick_nodes_, j, k));
  });
  std::uint32_t any = 0, all = whole;
  const auto record_row = [&](int j, int k, std::uint32_t bits) {
    rows[row_index(j, k)] = bits;
    any |= bits;
    all &= bits;
  };
  for_each_row([&](std::size_t k) { return empty_rows[k]; }, [&](int j, int k) { record_row(j, k, 0); });
  for_each_row([&](std::size_t k) { return solid_rows[k]; }, [&](int j, int k) { record_row(j, k, whole); });
  for_each_row(unknown, [&](int j, int k) {
    const float* row = nodes.at(0, j, k);
    std::uint32_t bits = bits_above(row, brick_nodes_, crossings_.isovalue);
    bits |= static_cast<std::uint32_t>(row[brick_nodes_] > crossings_.isovalue) << brick_nodes_;
    if (bits == 0) empty_rows[static_cast<std::size_t>(k)] |= 1u << j;
    record_row(j, k, bits);
  });
  if (any == 0) return Occupancy::no_bone;
  return all == whole ? Occupancy::all_bone : Occupancy::surface;
}

// Converts bits of a row's nodes into bits of its cells.
std::uint32_t SurfaceLattice::cells_of(std::uint32_t nodes) const {
  if (group_ == 1) return nodes;
  std::uint32_t cells = 0;
  for (; nodes != 0; nodes &= nodes - 1) cells |= 1u << (std::countr_zero(nodes) / group_);
  return cells;
}

// Computes one point per cell, one row of cells after the other.
void SurfaceLattice::add_cell_means(const Nodes& nodes, const Rows& rows, BrickSurface& surface) const {
  const int side = brick_nodes_ / group_;
  CrossingLattice lattice = crossings_;
  std::copy(nodes.next.begin(), nodes.next.end(), lattice.next);
  std::array<CrossingRow, kMaxGroup * kMaxGroup> crossed_rows;
  for (int cell_k = 0; cell_k < side; ++cell_k) {
    for (int cell_j = 0; cell_j < side; ++cell_j) {
      std::size_t count = 0;
      std::uint32_t crossed = 0;
      for (int k = group_ * cell_k; k < group_ * (cell_k + 1); ++k) {
        const int step = is_on_line(k) ? 1 : line_step_;
        for (int j = group_ * cell_j; j < group_ * (cell_j + 1); j += step) {
          std::uint32_t edges[3];
          if (!find_crossed(rows, j, k, edges)) continue;
          crossed |= edges[0] | edges[1] | edges[2];
          // The row's first node is at -1 in the brick's frame.
          crossed_rows[count++] = {nodes.at(0, j, k), -1, j - 1, k - 1, {edges[0], edges[1], edges[2]}};
        }
      }
      if (crossed == 0) continue;
      std::uint32_t cells = cells_of(crossed);
      std::size_t n = surface.fine.count;
      add_means(lattice, {crossed_rows.data(), count}, group_, cells, surface.fine);
      const int row = 4 * (cell_j / 2) + 16 * (cell_k / 2);
      for (; cells != 0; cells &= cells - 1) {
        surface.coarse_cell[n++] = static_cast<std::uint8_t>(std::countr_zero(cells) / 2 + row);
      }
    }
  }
}

void SurfaceLattice::merge_flat_cells(BrickSurface& surface) {
  const PointRows& fine = surface.fine;
  surface.coarse.count = 0;
  std::array<Mean, 64> cells;
  for (std::size_t n = 0; n < fine.count; ++n) cells[surface.coarse_cell[n]].add(fine.point(n));
  std::array<bool, 64> flat{};
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cells[cell].is_empty()) continue;
    const ShellPoint mean = cells[cell].mean();
    flat[cell] = is_flat(mean);
    if (flat[cell]) surface.coarse.add(mean);
  }
  for (std::size_t n = 0; n < fine.count; ++n) {
    if (!flat[surface.coarse_cell[n]]) surface.coarse.add(fine.point(n));
  }
}

}  // namespace osteomill
