#include "osteomill/volume/bone_pieces.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

namespace osteomill {

namespace {

// Consecutive bone voxels of a row.
struct Run {
  int first;
  int last;
};

// Runs of a bone and their connected components (union-find).
class ConnectedRuns {
 public:
  ConnectedRuns(const DensityGrid& grid, double isovalue) : rows_per_slice_(grid.geometry().dims[1]) {
    begin_of_row_.push_back(0);
    VoxelBox rows = grid.geometry().all_voxels();
    rows.last.i = 0;
    for_each_with_progress(rows, [&](const VoxelIndex& row) {
      add_row(grid.row(row.j, row.k), isovalue);
      connect_row(row.j, row.k);
    });
  }

  // Calls `use(run, piece)` for each run of a row. A piece is identified by the index of its first run.
  template <typename Use>
  void for_each_in_row(int j, int k, const Use& use) {
    for (std::size_t n = begin_of_row_[row(j, k)]; n < begin_of_row_[row(j, k) + 1]; ++n)
      use(runs_[n], piece_of(n));
  }

  // Returns the piece of a voxel; nullopt if it is not bone.
  std::optional<std::size_t> piece_with(const VoxelIndex& voxel) {
    std::optional<std::size_t> found;
    for_each_in_row(voxel.j, voxel.k, [&](const Run& run, std::size_t piece) {
      if (run.first <= voxel.i && voxel.i <= run.last) found = piece;
    });
    return found;
  }

  // Returns the voxel count of each piece, by its index; 0 for runs that do not identify a piece.
  std::vector<std::size_t> sizes() {
    std::vector<std::size_t> voxels(runs_.size());
    for (std::size_t n = 0; n < runs_.size(); ++n)
      voxels[piece_of(n)] += static_cast<std::size_t>(runs_[n].last - runs_[n].first + 1);
    return voxels;
  }

 private:
  std::size_t row(int j, int k) const {
    return static_cast<std::size_t>(j) +
           static_cast<std::size_t>(rows_per_slice_) * static_cast<std::size_t>(k);
  }

  void add_row(std::span<const float> densities, double isovalue) {
    const int length = static_cast<int>(densities.size());
    for (int i = 0; i < length; ++i) {
      if (!(static_cast<double>(densities[static_cast<std::size_t>(i)]) > isovalue)) continue;
      if (runs_.size() > begin_of_row_.back() && runs_.back().last == i - 1) {
        runs_.back().last = i;
      } else {
        parents_.push_back(runs_.size());
        runs_.push_back({i, i});
      }
    }
    begin_of_row_.push_back(runs_.size());
  }

  // Connects the row added last with its neighbours among the earlier rows.
  void connect_row(int j, int k) {
    if (j > 0) connect(row(j, k), row(j - 1, k));
    if (k == 0) return;
    for (int other = std::max(0, j - 1); other <= std::min(rows_per_slice_ - 1, j + 1); ++other)
      connect(row(j, k), row(other, k - 1));
  }

  void connect(std::size_t row, std::size_t other) {
    std::size_t a = begin_of_row_[row], b = begin_of_row_[other];
    while (a < begin_of_row_[row + 1] && b < begin_of_row_[other + 1]) {
      if (runs_[a].first <= runs_[b].last + 1 && runs_[b].first <= runs_[a].last + 1) {
        const auto [low, high] = std::minmax({piece_of(a), piece_of(b)});
        parents_[high] = low;
      }
      runs_[a].last < runs_[b].last ? ++a : ++b;
    }
  }

  std::size_t piece_of(std::size_t run) {
    while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
    return run;
  }

  int rows_per_slice_;
  std::vector<Run> runs_;
  std::vector<std::size_t> parents_;
  std::vector<std::size_t> begin_of_row_;
};

std::vector<std::size_t> largest_first(std::vector<std::size_t> sizes) {
  std::erase(sizes, std::size_t{0});
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

// Calls `use(run, piece, j, k)` with every run of the grid.
template <typename Use>
void for_each_run(const GridGeometry& geometry, ConnectedRuns& runs, const Use& use) {
  VoxelBox rows = geometry.all_voxels();
  rows.last.i = 0;
  for_each_with_progress(rows, [&](const VoxelIndex& row) {
    runs.for_each_in_row(row.j, row.k,
                         [&](const Run& run, std::size_t piece) { use(run, piece, row.j, row.k); });
  });
}

// Copies of a grid's bricks in which removed voxels are set to the grid's lowest density.
class EmptiedBricks {
 public:
  EmptiedBricks(const DensityGrid& grid, std::size_t max_bricks)
      : grid_(grid), max_bricks_(max_bricks), last_brick_(grid.geometry().all_voxels().bricks(kSide).last) {
    const std::array<int, 3> bricks{last_brick_.i + 1, last_brick_.j + 1, last_brick_.k + 1};
    places_.assign(cell_count(bricks), kNone);
  }

  void empty(const Run& run, int j, int k) {
    for (int i = run.first; i <= run.last;) {
      DensityBlock& brick = brick_at({i / kSide, j / kSide, k / kSide});
      const int end = std::min(run.last, brick.last().i) + 1;
      std::fill_n(&brick.densities[brick.index_of({i, j, k})], end - i, grid_.outside_density());
      i = end;
    }
  }
  std::vector<DensityBlock> take() { return std::move(bricks_); }

 private:
  static constexpr int kSide = DensityBlock::kVoxels;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  DensityBlock& brick_at(const VoxelIndex& brick) {
    std::size_t& place = places_[row_major({last_brick_.i + 1, last_brick_.j + 1, last_brick_.k + 1}, brick.i,
                                           brick.j, brick.k)];
    if (place == kNone) {
      if (bricks_.size() == max_bricks_)
        throw std::length_error(
            "removing these pieces takes more memory than undo allows; "
            "use --keep-largest or --min-piece when opening the scan");
      place = bricks_.size();
      bricks_.emplace_back(grid_, VoxelBox::of_brick(brick, kSide).first);
    }
    return bricks_[place];
  }

  const DensityGrid& grid_;
  std::size_t max_bricks_;
  VoxelIndex last_brick_;
  std::vector<std::size_t> places_;
  std::vector<DensityBlock> bricks_;
};

}  // namespace

template <>
const std::vector<Field<PieceChoice>>& fields_of<PieceChoice>() {
  using P = PieceChoice;
  static const std::vector<Field<P>> all{
      field<P>({"scan.only_largest", "", NumberRange::on_or_off(),
                "Remove all pieces of bone except the largest", kMayBeAbsent, "keep-largest"},
               &P::only_largest),
      field<P>({"scan.min_piece", "mm^3", NumberRange::not_negative(),
                "Remove pieces of bone smaller than this volume", kMayBeAbsent, "min-piece"},
               &P::min_mm3)};
  return all;
}

std::vector<std::size_t> piece_sizes(const DensityGrid& grid, double isovalue) {
  return largest_first(ConnectedRuns(grid, isovalue).sizes());
}

DiscardedPieces discard_pieces(DensityGrid& grid, double isovalue, const PieceChoice& choice) {
  ConnectedRuns runs(grid, isovalue);
  const std::vector<std::size_t> sizes = runs.sizes();
  const auto largest = static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  const double voxel_mm3 = grid.geometry().voxel_volume_mm3();
  const auto is_kept = [&](std::size_t piece) {
    return (!choice.only_largest || piece == largest) &&
           static_cast<double>(sizes[piece]) * voxel_mm3 >= choice.min_mm3;
  };
  DiscardedPieces result;
  for (std::size_t piece = 0; piece < sizes.size(); ++piece) {
    if (sizes[piece] == 0) continue;
    ++(is_kept(piece) ? result.kept : result.pieces);
    if (!is_kept(piece)) result.voxels += sizes[piece];
  }
  for_each_run(grid.geometry(), runs, [&](const Run& run, std::size_t piece, int j, int k) {
    if (is_kept(piece)) return;
    for (int i = run.first; i <= run.last; ++i) grid.set({i, j, k}, grid.outside_density());
  });
  return result;
}

std::optional<BonePiece> piece_at(const DensityGrid& grid, double isovalue, const VoxelIndex& voxel) {
  ConnectedRuns runs(grid, isovalue);
  const auto chosen = runs.piece_with(voxel);
  if (!chosen) return std::nullopt;
  BonePiece result;
  result.sizes = runs.sizes();
  result.voxels = result.sizes[*chosen];
  for_each_run(grid.geometry(), runs, [&](const Run& run, std::size_t piece, int j, int k) {
    if (piece != *chosen) return;
    result.box.include({run.first, j, k});
    result.box.include({run.last, j, k});
  });
  result.sizes = largest_first(std::move(result.sizes));
  return result;
}

std::vector<DensityBlock> bricks_without(const DensityGrid& grid, double isovalue,
                                         const PieceRemoval& removal, std::size_t max_bricks) {
  using Which = PieceRemoval::Which;
  ConnectedRuns runs(grid, isovalue);
  const std::vector<std::size_t> sizes = runs.sizes();
  const auto chosen = runs.piece_with(removal.voxel);
  if (removal.which != Which::smaller && !chosen)
    throw std::invalid_argument("the chosen piece is no longer bone; choose another");
  const double voxel_mm3 = grid.geometry().voxel_volume_mm3();
  EmptiedBricks bricks(grid, max_bricks);
  for_each_run(grid.geometry(), runs, [&](const Run& run, std::size_t piece, int j, int k) {
    const bool is_removed = removal.which == Which::smaller
                                ? static_cast<double>(sizes[piece]) * voxel_mm3 < removal.min_mm3
                                : (piece == *chosen) == (removal.which == Which::chosen);
    if (is_removed) bricks.empty(run, j, k);
  });
  return bricks.take();
}

}  // namespace osteomill
