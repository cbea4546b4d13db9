#include "osteomill/haptics/barrier_shell/surface_lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "osteomill/haptics/bone_points/bits_above.h"

namespace osteomill::barrier_shell {

namespace {

// Of the area of a cell's face that a crossing stands for.
constexpr float kMinSeen = 0.02f;
constexpr float kSeenWithoutNormal = 0.6f;
// Of the mean normal of points that one may stand for.
constexpr float kFlat = 0.98f;

int divide_down(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

float largest_float_up_to(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value
             ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
             : nearest;
}

// The weighted means of the points in each cell of a brick.
class Cells {
 public:
  Cells(int brick_nodes, int cell_nodes)
      : cells_(brick_nodes / cell_nodes), shift_(std::countr_zero(static_cast<unsigned>(cell_nodes))) {
    std::fill_n(sums_.begin(), count(), ShellPoint{0, 0, 0, 0});
  }
  std::size_t count() const { return static_cast<std::size_t>(cells_ * cells_ * cells_); }
  /// Of the cell that holds a node.
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>((i >> shift_) + cells_ * ((j >> shift_) + cells_ * (k >> shift_)));
  }
  void add(std::size_t cell, const ShellPoint& point) {
    ShellPoint& sum = sums_[cell];
    sum.x_mm += point.area_mm2 * point.x_mm;
    sum.y_mm += point.area_mm2 * point.y_mm;
    sum.z_mm += point.area_mm2 * point.z_mm;
    sum.area_mm2 += point.area_mm2;
    sum.normal_x += point.area_mm2 * point.normal_x;
    sum.normal_y += point.area_mm2 * point.normal_y;
    sum.normal_z += point.area_mm2 * point.normal_z;
  }
  bool is_empty(std::size_t cell) const { return !(sums_[cell].area_mm2 > 0); }
  /// The mean normal is the shorter the more the surface bends; one where nothing is known of it.
  ShellPoint mean(std::size_t cell) const {
    const ShellPoint& sum = sums_[cell];
    const float share = 1 / sum.area_mm2;
    return {share * sum.x_mm,     share * sum.y_mm,     share * sum.z_mm,    sum.area_mm2,
            share * sum.normal_x, share * sum.normal_y, share * sum.normal_z};
  }

 private:
  int cells_;
  int shift_;
  std::array<ShellPoint, 512> sums_;
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
  steps_per_voxel_ = std::max(1, static_cast<int>(std::ceil(voxel_mm / spacing_mm - kRounding)));
  // A brick of 16 nodes holds two cells of eight a side.
  while (group_ < 8 && 2 * group_ * voxel_mm <= spacing_mm * (1 + kRounding)) group_ *= 2;
  brick_nodes_ = group_ == 1 ? 8 : kMaxBrickNodes;
  step_mm_ = geometry.spacing_mm / steps_per_voxel_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int nodes = (geometry.dims[axis] - 1) * steps_per_voxel_ + 1;
    brick_dims_[axis] = (nodes + brick_nodes_) / brick_nodes_;
  }
  step_ = step_mm_.cast<float>();
  per_step_ = step_mm_.cwiseInverse().cast<float>();
  face_mm2_ = (step_mm_.prod() * step_mm_.cwiseInverse()).cast<float>();
  isovalue_ = largest_float_up_to(volume.isovalue());
  outside_ = std::min(volume.grid().outside_density(), isovalue_ - 1);
}

float SurfaceLattice::density(const VoxelIndex& voxel) const {
  return volume_->grid().contains(voxel) ? volume_->grid()[voxel] : outside_;
}

// The voxels that a brick's crossings (not their weights) depend on; beyond the grid too.
VoxelBox SurfaceLattice::voxels_of(const VoxelIndex& brick) const {
  const int n = brick_nodes_, s = steps_per_voxel_;
  const auto first = [&](int b) { return divide_down(n * b - 1, s); };
  const auto last = [&](int b) { return divide_down(n * b + n - 2, s) + 1; };
  return {{first(brick.i), first(brick.j), first(brick.k)}, {last(brick.i), last(brick.j), last(brick.k)}};
}

bool SurfaceLattice::may_hold_surface(const VoxelIndex& brick) const {
  constexpr int kRange = BlockRanges::kBrickVoxels;
  const VoxelBox voxels = voxels_of(brick);
  const VoxelBox inside = voxels.intersected(volume_->geometry().all_voxels());
  const BlockRanges& ranges = volume_->bricks();
  bool any_bone = false, all_bone = inside == voxels;
  for (int k = inside.first.k / kRange; k <= inside.last.k / kRange; ++k) {
    for (int j = inside.first.j / kRange; j <= inside.last.j / kRange; ++j) {
      for (int i = inside.first.i / kRange; i <= inside.last.i / kRange; ++i) {
        any_bone |= ranges.at(i, j, k).max > isovalue_;
        all_bone &= ranges.at(i, j, k).min > isovalue_;
      }
    }
  }
  if (!any_bone || all_bone) return false;
  if (steps_per_voxel_ == 1) return true;
  // A brick within a few voxels of a coarse scan: look at them.
  any_bone = false;
  all_bone = inside == voxels;
  for (int k = inside.first.k; k <= inside.last.k; ++k) {
    for (int j = inside.first.j; j <= inside.last.j; ++j) {
      for (int i = inside.first.i; i <= inside.last.i; ++i) {
        const bool bone = volume_->grid()[{i, j, k}] > isovalue_;
        any_bone |= bone;
        all_bone &= bone;
      }
    }
  }
  return any_bone && !all_bone;
}

VoxelBox SurfaceLattice::bricks_touched_by(const VoxelBox& voxels) const {
  if (voxels.empty()) return voxels;
  const int n = brick_nodes_, s = steps_per_voxel_;
  // A node reads voxels less than one away; a crossing's weight nodes from one below its lower one to two
  // above; and a brick's first lower node is one below its own.
  const auto first = [&](int v) { return std::max(0, divide_down((v - 1) * s + 1 - 2 + 1, n)); };
  const auto last = [&](int v, std::size_t axis) {
    return std::min(brick_dims_[axis] - 1, divide_down((v + 1) * s - 1 + 1 + 1, n));
  };
  return {{first(voxels.first.i), first(voxels.first.j), first(voxels.first.k)},
          {last(voxels.last.i, 0), last(voxels.last.j, 1), last(voxels.last.k, 2)}};
}

void SurfaceLattice::read_block(const VoxelIndex& brick, Block& block) const {
  const VoxelIndex first{brick_nodes_ * brick.i - 2, brick_nodes_ * brick.j - 2, brick_nodes_ * brick.k - 2};
  if (steps_per_voxel_ == 1) {
    read_voxels(first, block);
  } else {
    interpolate_voxels(first, block);
  }
}

void SurfaceLattice::read_voxels(const VoxelIndex& first, Block& block) const {
  const int count = brick_nodes_ + 3;
  const DensityGrid& grid = volume_->grid();
  const bool inside =
      grid.contains(first) && grid.contains({first.i + count - 1, first.j + count - 1, first.k + count - 1});
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) {
      float* row = &block[static_cast<std::size_t>(k) * kSlice + static_cast<std::size_t>(j) * kRow];
      if (inside) {
        const float* from = grid.densities().data() + grid.linear_index({first.i, first.j + j, first.k + k});
        if (count == 11) {
          std::memcpy(row, from, 12 * sizeof(float));
        } else {
          std::memcpy(row, from, 20 * sizeof(float));
        }
      } else {
        for (int i = 0; i < count; ++i) row[i] = density({first.i + i, first.j + j, first.k + k});
      }
    }
  }
}

// Trilinear, one axis after the other. Every voxel has a weight of at least zero, so that a node's density
// falls with its voxels'.
void SurfaceLattice::interpolate_voxels(const VoxelIndex& first, Block& block) const {
  const int count = brick_nodes_ + 3, s = steps_per_voxel_;
  const auto voxel = [&](int node) { return divide_down(node, s); };
  const VoxelIndex from{voxel(first.i), voxel(first.j), voxel(first.k)};
  const float per_step = 1.0f / static_cast<float>(s);
  struct Place {
    std::size_t cell;
    float fraction;
  };
  std::array<std::array<Place, kMaxBlockNodes>, 3> places;
  const std::array<int, 3> nodes{first.i, first.j, first.k}, voxels{from.i, from.j, from.k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int n = 0; n < count; ++n) {
      const int cell = voxel(nodes[axis] + n);
      places[axis][static_cast<std::size_t>(n)] = {static_cast<std::size_t>(cell - voxels[axis]),
                                                   per_step * static_cast<float>(nodes[axis] + n - s * cell)};
    }
  }
  const std::size_t n = static_cast<std::size_t>(count);
  const auto needed = [&](std::size_t axis) { return places[axis][n - 1].cell + 2; };
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
        const Place& p = places[0][i];
        rows[j * kRow + i] = between(row[p.cell], row[p.cell + 1], p.fraction);
      }
    }
    for (std::size_t j = 0; j < n; ++j) {
      const Place& p = places[1][j];
      for (std::size_t i = 0; i < n; ++i) {
        slices[k * kSlice + j * kRow + i] =
            between(rows[p.cell * kRow + i], rows[(p.cell + 1) * kRow + i], p.fraction);
      }
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    const Place& p = places[2][k];
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = j * kRow + i;
        block[k * kSlice + at] =
            between(slices[p.cell * kSlice + at], slices[(p.cell + 1) * kSlice + at], p.fraction);
      }
    }
  }
}

// Where the surface crosses the edge from a node along `axis`; `here` is the node's density in its block, and
// `node` the node in the brick's frame.
ShellPoint SurfaceLattice::crossing(const float* here, const VoxelIndex& node, int axis) const {
  constexpr std::ptrdiff_t kNext[3] = {1, kRow, kSlice};
  const float* there = here + kNext[axis];
  const float fraction = (isovalue_ - *here) / (*there - *here);
  float gradient[3];
  for (int a = 0; a < 3; ++a) {
    const float from = here[kNext[a]] - here[-kNext[a]], to = there[kNext[a]] - there[-kNext[a]];
    gradient[a] = (from + fraction * (to - from)) * per_step_[a];
  }
  const float steepness =
      std::sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  const float outward = steepness > 0 ? -1 / steepness : 0;
  const float seen =
      steepness > 0 ? std::max(kMinSeen, std::abs(outward * gradient[axis])) : kSeenWithoutNormal;
  float at[3] = {static_cast<float>(node.i), static_cast<float>(node.j), static_cast<float>(node.k)};
  at[axis] += fraction;
  return {at[0] * step_[0],      at[1] * step_[1],      at[2] * step_[2],     face_mm2_[axis] * seen,
          outward * gradient[0], outward * gradient[1], outward * gradient[2]};
}

int SurfaceLattice::find_surface(const VoxelIndex& brick, BrickSurface& surface) const {
  surface.fine_count = surface.coarse_count = 0;
  Block block;
  read_block(brick, block);
  const std::uint64_t before = surface.fingerprint;
  surface.fingerprint = fingerprint_of(block);
  if (surface.fingerprint == before) return kUnchanged;
  Rows rows;
  if (!find_bone(block, rows)) return 0;
  const int crossed =
      group_ == 1 ? list_crossings(block, rows, surface) : mean_crossings(block, rows, surface);
  merge_flat_cells(surface);
  return crossed;
}

// Of the bits of all densities; never 0.
std::uint64_t SurfaceLattice::fingerprint_of(const Block& block) const {
  constexpr std::size_t kLanes = 8;
  std::uint32_t lanes[kLanes] = {1, 2, 3, 4, 5, 6, 7, 8};
  const int count = brick_nodes_ + 3;
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) {
      const float* row = &block[block_index(-1, j - 1, k - 1)];
      for (int i = 0; i < count; i += kLanes) {
        std::uint32_t bits[kLanes];
        // The last ones overlap: every density is taken in, some twice.
        std::memcpy(bits, row + std::min(i, count - static_cast<int>(kLanes)), sizeof bits);
        for (std::size_t n = 0; n < kLanes; ++n) lanes[n] = ((lanes[n] << 5) | (lanes[n] >> 27)) ^ bits[n];
      }
    }
  }
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::uint32_t lane : lanes) hash = (hash ^ lane) * 0x100000001b3;
  return hash | 1;
}

// Whether bone and no bone meet in the brick.
bool SurfaceLattice::find_bone(const Block& block, Rows& rows) const {
  std::uint32_t any = 0, all = ~0u;
  for (int k = 0; k <= brick_nodes_; ++k) {
    for (int j = 0; j <= brick_nodes_; ++j) {
      const float* row = &block[block_index(0, j, k)];
      std::uint32_t bits = eight_above(row, isovalue_);
      if (brick_nodes_ == 16) bits |= static_cast<std::uint32_t>(eight_above(row + 8, isovalue_)) << 8;
      bits |= static_cast<std::uint32_t>(row[brick_nodes_] > isovalue_) << brick_nodes_;
      rows[row_index(j, k)] = bits;
      any |= bits;
      all &= bits;
    }
  }
  const std::uint32_t whole = (2u << brick_nodes_) - 1;
  return any != 0 && (all & whole) != whole;
}

// Calls f(i, j, k, point) for every edge that is crossed, by its lower node.
template <typename F>
int SurfaceLattice::for_each_crossing(const Block& block, const Rows& rows, F&& f) const {
  int crossed = 0;
  const std::uint32_t lower = (1u << brick_nodes_) - 1;
  for (int k = 0; k < brick_nodes_; ++k) {
    for (int j = 0; j < brick_nodes_; ++j) {
      const std::uint32_t here = rows[row_index(j, k)];
      const std::uint32_t edges[3] = {(here ^ (here >> 1)) & lower,
                                      (here ^ rows[row_index(j + 1, k)]) & lower,
                                      (here ^ rows[row_index(j, k + 1)]) & lower};
      for (int axis = 0; axis < 3; ++axis) {
        for (std::uint32_t left = edges[axis]; left != 0; left &= left - 1) {
          const int i = std::countr_zero(left);
          // The brick's frame begins one node above its first.
          f(i, j, k, crossing(&block[block_index(i, j, k)], {i - 1, j - 1, k - 1}, axis));
          ++crossed;
        }
      }
    }
  }
  return crossed;
}

int SurfaceLattice::list_crossings(const Block& block, const Rows& rows, BrickSurface& surface) const {
  return for_each_crossing(block, rows, [&](int i, int j, int k, const ShellPoint& point) {
    surface.coarse_cell[surface.fine_count] = static_cast<std::uint8_t>(i / 2 + 4 * (j / 2) + 16 * (k / 2));
    surface.fine[surface.fine_count++] = point;
  });
}

int SurfaceLattice::mean_crossings(const Block& block, const Rows& rows, BrickSurface& surface) const {
  Cells cells(brick_nodes_, group_);
  const int crossed = for_each_crossing(block, rows, [&](int i, int j, int k, const ShellPoint& point) {
    cells.add(cells.index(i, j, k), point);
  });
  const int side = brick_nodes_ / group_;
  for (int k = 0, cell = 0; k < side; ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i, ++cell) {
        if (cells.is_empty(static_cast<std::size_t>(cell))) continue;
        surface.coarse_cell[surface.fine_count] =
            static_cast<std::uint8_t>(i / 2 + 4 * (j / 2) + 16 * (k / 2));
        surface.fine[surface.fine_count++] = cells.mean(static_cast<std::size_t>(cell));
      }
    }
  }
  return crossed;
}

// One point for all in a cell twice as wide where they lie in a plane; along edges all stay.
void SurfaceLattice::merge_flat_cells(BrickSurface& surface) {
  Cells cells(8, 2);
  for (std::size_t n = 0; n < surface.fine_count; ++n) cells.add(surface.coarse_cell[n], surface.fine[n]);
  std::array<bool, 64> flat{};
  for (std::size_t cell = 0; cell < cells.count(); ++cell) {
    if (cells.is_empty(cell)) continue;
    const ShellPoint mean = cells.mean(cell);
    flat[cell] = is_flat(mean);
    if (flat[cell]) surface.coarse[surface.coarse_count++] = mean;
  }
  for (std::size_t n = 0; n < surface.fine_count; ++n) {
    if (!flat[surface.coarse_cell[n]]) surface.coarse[surface.coarse_count++] = surface.fine[n];
  }
}

}  // namespace osteomill::barrier_shell
