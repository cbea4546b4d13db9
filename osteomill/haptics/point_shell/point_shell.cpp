#include "osteomill/haptics/point_shell/point_shell.h"

#include <algorithm>
#include <bit>

#include "osteomill/numbers/work_progress.h"

namespace osteomill::point_shell {

namespace {

// Room for the surface that milling lays bare: as much again as there is, and a fixed spare (32 points a
// chunk).
constexpr std::size_t kSpareChunks = 8192;

// What looking at a brick costs, in points computed, where a cell is one node.
constexpr int kBrickCost = 10;
constexpr int kLoweredBrickCost = 8;
constexpr int kBrickPassedOverCost = 1;

std::uint32_t count_of(const std::array<std::uint8_t, 64>& mask) {
  std::uint32_t count = 0;
  for (const std::uint8_t byte : mask) count += static_cast<std::uint32_t>(std::popcount(byte));
  return count;
}

// Calls f(i, j, k) with 0 <= i, j, k < 8 for every bit that is set, i running fastest.
template <typename F>
void for_each_cell(const std::array<std::uint8_t, 64>& mask, F&& f) {
  for (int row = 0; row < 64; ++row) {
    for (unsigned bits = mask[static_cast<std::size_t>(row)]; bits != 0; bits &= bits - 1) {
      f(std::countr_zero(bits), row % 8, row / 8);
    }
  }
}

bool has_cell(const std::array<std::uint8_t, 64>& mask, int i, int j, int k) {
  return (mask[static_cast<std::size_t>(j + 8 * k)] >> i & 1) != 0;
}

VoxelBox brick_cells(int bi, int bj, int bk) {
  constexpr int n = PointShell::kBrickCells;
  return {{n * bi, n * bj, n * bk}, {n * bi + n - 1, n * bj + n - 1, n * bk + n - 1}};
}

VoxelBox bricks_of(const VoxelBox& cells) {
  constexpr int n = PointShell::kBrickCells;
  return {{cells.first.i / n, cells.first.j / n, cells.first.k / n},
          {cells.last.i / n, cells.last.j / n, cells.last.k / n}};
}

}  // namespace

PointShell::PointShell(const Volume& volume, const ShellRules& rules)
    : lattice_(volume, rules), bone_(lattice_.node_dims()) {
  const auto cells = lattice_.cell_dims();
  std::array<int, 3> bricks;
  for (std::size_t axis = 0; axis < 3; ++axis) bricks[axis] = (cells[axis] + kBrickCells - 1) / kBrickCells;
  octree_ = CountPyramid(bricks);
  masks_.resize(brick_index(0, 0, bricks[2]));
  brick_side_mm_ = kBrickCells * lattice_.group() * lattice_.geometry().spacing_mm;
  // A point on the isosurface may lie beyond its own cell, on the way to the next node.
  box_margin_mm_ = (rules.surface_shell ? 1.0 : 0.0) * lattice_.geometry().spacing_mm;

  const VoxelBox all_nodes = lattice_.geometry().all_voxels();
  find_bone();
  const VoxelBox all_cells = cells_of_nodes(all_nodes);
  std::size_t chunks = 0;
  const auto for_each_brick = [&](auto&& f) {
    for (int bk = 0; bk < bricks[2]; ++bk) {
      WorkProgress::done(static_cast<std::size_t>(bk), static_cast<std::size_t>(bricks[2]));
      for (int bj = 0; bj < bricks[1]; ++bj) {
        for (int bi = 0; bi < bricks[0]; ++bi) f(bi, bj, bk);
      }
    }
  };
  {
    const WorkProgress::Part counting(0.4);
    for_each_brick([&](int bi, int bj, int bk) {
      chunks += (count_of(mask_of(bi, bj, bk, all_cells, {})) + PointChunk::kSlots - 1) / PointChunk::kSlots;
    });
  }
  {
    const WorkProgress::Part making_room(0.6);
    points_ = BrickPoints(masks_.size(), 2 * chunks + kSpareChunks);
  }
  const WorkProgress::Part placing(1);
  old_points_.resize(kMaxPointsOfBrick);
  new_points_.resize(kMaxPointsOfBrick);
  for_each_brick([&](int bi, int bj, int bk) { refresh_brick(bi, bj, bk, all_cells); });
}

void PointShell::refresh(const VoxelBox& voxels) {
  sweep_.wait_for(voxels);
  const ShellRules& rules = lattice_.rules();
  const int budget = rules.surface_shell ? rules.refreshed_points_per_tick : 0;
  int spent = 0;
  while (sweep_.is_walking() || start_sweep()) {
    if (budget != 0 && spent != 0 && spent + cost_of_next_brick() > budget) return;
    spent += visit(sweep_.brick());
    sweep_.advance();
  }
}

// Begins with what has waited; changes from now on wait for the sweep after.
bool PointShell::start_sweep() {
  const VoxelBox nodes = lattice_.nodes_touched_by(sweep_.take_waiting());
  if (nodes.empty()) return false;
  swept_nodes_ = nodes;
  swept_cells_ =
      cells_of_nodes(nodes.grown(lattice_.reach_nodes()).intersected(lattice_.geometry().all_voxels()));
  sweep_.start(bricks_of(swept_cells_));
  return true;
}

// As far as can be told without a look; `visit` says what it was.
int PointShell::cost_of_next_brick() const {
  const VoxelIndex& b = sweep_.brick();
  return sweep_.is_first_pass() ? lowering_cost()
                                : refreshing_cost(static_cast<int>(octree_.count(0, b.i, b.j, b.k)));
}

// Every node of a brick is looked at, and for a point the nodes of its cell that lie on the surface.
int PointShell::lowering_cost() const {
  const int g = lattice_.group();
  return g * g * g * kLoweredBrickCost;
}

int PointShell::refreshing_cost(int points) const {
  const int g = lattice_.group();
  return g * g * (g * kBrickCost + points);
}

int PointShell::visit(const VoxelIndex& b) {
  if (holds_no_bone(b) || lattice_.is_deep_in_bone(b.i, b.j, b.k)) return kBrickPassedOverCost;
  // The second time for what has fallen since the first.
  lower_bone(nodes_of_brick(b).intersected(swept_nodes_));
  if (sweep_.is_first_pass()) return lowering_cost();
  return refreshing_cost(refresh_brick(b.i, b.j, b.k, swept_cells_));
}

VoxelBox PointShell::nodes_of_brick(const VoxelIndex& b) const {
  const int n = kBrickCells * lattice_.group();
  return {{n * b.i, n * b.j, n * b.k}, {n * b.i + n - 1, n * b.j + n - 1, n * b.k + n - 1}};
}

// Where there is none there will be none.
bool PointShell::holds_no_bone(const VoxelIndex& b) const {
  if (octree_.count(0, b.i, b.j, b.k) != 0) return false;
  const VoxelBox own = nodes_of_brick(b).intersected(lattice_.geometry().all_voxels());
  unsigned bits = 0;
  for (int k = own.first.k; k <= own.last.k; ++k) {
    for (int j = own.first.j; j <= own.last.j; ++j) {
      for (int byte = own.first.i / 8; byte <= own.last.i / 8; ++byte) bits |= bone_.byte(byte, j, k);
    }
  }
  return bits == 0;
}

void PointShell::find_bone() {
  const auto& dims = lattice_.node_dims();
  for (int k = 0; k < dims[2]; ++k) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; ++j) {
      for (int byte = 0; 8 * byte < dims[0]; ++byte)
        bone_.set_byte(byte, j, k, lattice_.bone_byte(byte, j, k));
    }
  }
}

// Densities only fall: what was not bone needs no second look.
void PointShell::lower_bone(const VoxelBox& nodes) {
  lattice_.prefetch_rows(nodes);
  for (int k = nodes.first.k; k <= nodes.last.k; ++k) {
    for (int j = nodes.first.j; j <= nodes.last.j; ++j) {
      for (int byte = nodes.first.i / 8; byte <= nodes.last.i / 8; ++byte) {
        const unsigned before = bone_.byte(byte, j, k);
        const unsigned from = 0xffu << std::max(0, nodes.first.i - 8 * byte);
        const unsigned to = (1u << std::min(8, nodes.last.i + 1 - 8 * byte)) - 1;
        if ((before & from & to) == 0) continue;
        const unsigned after = before & (lattice_.bone_byte(byte, j, k) | ~(from & to));
        if (after != before) bone_.set_byte(byte, j, k, static_cast<std::uint8_t>(after));
      }
    }
  }
}

VoxelBox PointShell::cells_of_nodes(const VoxelBox& nodes) const {
  const int g = lattice_.group();
  return {{nodes.first.i / g, nodes.first.j / g, nodes.first.k / g},
          {nodes.last.i / g, nodes.last.j / g, nodes.last.k / g}};
}

// The cells 8 bi to 8 bi + 7 of row j of slice k that have a point: those with a node on the surface.
std::uint8_t PointShell::mask_byte(int bi, int j, int k) const {
  const int g = lattice_.group();
  if (g == 1) return bone_.surface_byte(bi, j, k);
  const auto& dims = lattice_.node_dims();
  const int end_j = std::min(g * j + g, dims[1]), end_k = std::min(g * k + g, dims[2]);
  const int end_byte = std::min(g * bi + g, (dims[0] + 7) / 8);
  unsigned cells = 0;
  for (int byte = g * bi; byte < end_byte; ++byte) {
    unsigned nodes = 0;
    for (int node_k = g * k; node_k < end_k; ++node_k) {
      for (int node_j = g * j; node_j < end_j; ++node_j) nodes |= bone_.surface_byte(byte, node_j, node_k);
    }
    const int first = 8 * (byte - g * bi);
    for (; nodes != 0; nodes &= nodes - 1) cells |= 1u << ((first + std::countr_zero(nodes)) / g);
  }
  return static_cast<std::uint8_t>(cells);
}

// `mask` with the rows of `cells` made new.
PointShell::CellMask PointShell::mask_of(int bi, int bj, int bk, const VoxelBox& cells, CellMask mask) const {
  const VoxelBox own = brick_cells(bi, bj, bk);
  const VoxelBox rows = own.intersected(cells);
  for (int k = rows.first.k; k <= rows.last.k; ++k) {
    for (int j = rows.first.j; j <= rows.last.j; ++j) {
      mask[static_cast<std::size_t>(j - own.first.j + 8 * (k - own.first.k))] = mask_byte(bi, j, k);
    }
  }
  return mask;
}

int PointShell::refresh_brick(int bi, int bj, int bk, const VoxelBox& cells) {
  const CellMask& before = masks_[brick_index(bi, bj, bk)];
  const CellMask mask = mask_of(bi, bj, bk, cells, before);
  if (mask != before) return rebuild_brick(bi, bj, bk, cells, mask);
  if (lattice_.rules().surface_shell) return move_points(bi, bj, bk, cells);
  return 0;
}

// The same cells as before: only points near changed densities move.
int PointShell::move_points(int bi, int bj, int bk, const VoxelBox& cells) {
  const std::size_t brick = brick_index(bi, bj, bk);
  const std::uint32_t stored = points_.brick(brick).count;
  const VoxelIndex first = brick_cells(bi, bj, bk).first;
  std::uint32_t slot = 0;
  int computed = 0;
  for_each_cell(masks_[brick], [&](int i, int j, int k) {
    const VoxelIndex cell{first.i + i, first.j + j, first.k + k};
    if (cells.contains(cell) && slot < stored) {
      points_.move(brick, slot, point_of(cell, bi, bj, bk));
      ++computed;
    }
    ++slot;
  });
  return computed;
}

// Other cells than before: the points are listed anew, those far from the change as they were. Both lists run
// in the order of the cells.
int PointShell::rebuild_brick(int bi, int bj, int bk, const VoxelBox& cells, const CellMask& mask) {
  const std::size_t brick = brick_index(bi, bj, bk);
  const CellMask& before = masks_[brick];
  const std::uint32_t old_count = points_.brick(brick).count;
  points_.copy(brick, old_points_);
  std::size_t old_slot = 0, new_count = 0;
  int computed = 0;
  const VoxelIndex first = brick_cells(bi, bj, bk).first;
  const bool follow = lattice_.rules().surface_shell;
  CellMask either;
  for (std::size_t row = 0; row < either.size(); ++row) {
    either[row] = static_cast<std::uint8_t>(before[row] | mask[row]);
  }
  for_each_cell(either, [&](int i, int j, int k) {
    const VoxelIndex cell{first.i + i, first.j + j, first.k + k};
    const std::size_t slot = has_cell(before, i, j, k) ? old_slot++ : old_count;
    if (!has_cell(mask, i, j, k)) return;
    const bool keep = slot < old_count && !(follow && cells.contains(cell));
    if (!keep) ++computed;
    new_points_[new_count++] = keep ? old_points_[slot] : point_of(cell, bi, bj, bk);
  });
  const std::uint32_t stored = points_.replace(brick, {new_points_.data(), new_count});
  octree_.add(bi, bj, bk, static_cast<std::int32_t>(stored) - static_cast<std::int32_t>(old_count));
  masks_[brick] = mask;
  return computed;
}

ShellPoint PointShell::point_of(const VoxelIndex& cell, int bi, int bj, int bk) const {
  return lattice_.point_of_cell(bone_, cell, nodes_of_brick({bi, bj, bk}).first);
}

}  // namespace osteomill::point_shell
