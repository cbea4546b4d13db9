#include "osteomill/volume/bone_pieces.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <utility>

namespace osteomill {

namespace {

// Voxels of bone that follow each other in a row.
struct Run {
  int first;
  int last;
};

// The runs of a bone and which of them are connected (union-find).
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

  // Calls `use(run, its piece)`. A piece is the number of its first run.
  template <typename Use>
  void for_each_in_row(int j, int k, const Use& use) {
    for (std::size_t n = begin_of_row_[row(j, k)]; n < begin_of_row_[row(j, k) + 1]; ++n)
      use(runs_[n], piece_of(n));
  }

  // Returns how many voxels each piece has, by its number; 0 for numbers that are no piece's.
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

  // Connects the row that was added last with the neighbours that came before it.
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

}  // namespace

template <>
const std::vector<Field<PieceChoice>>& fields_of<PieceChoice>() {
  using P = PieceChoice;
  static const std::vector<Field<P>> all{
      field<P>({"scan.only_largest", "", NumberRange::on_or_off(),
                "Leave out every piece of bone but the largest", kMayBeAbsent, "keep-largest"},
               &P::only_largest),
      field<P>({"scan.min_piece", "mm^3", NumberRange::not_negative(),
                "Leave out pieces of bone that are smaller", kMayBeAbsent, "min-piece"},
               &P::min_mm3)};
  return all;
}

std::vector<std::size_t> piece_sizes(const DensityGrid& grid, double isovalue) {
  std::vector<std::size_t> sizes = ConnectedRuns(grid, isovalue).sizes();
  std::erase(sizes, std::size_t{0});
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

PiecesLeftOut leave_out_pieces(DensityGrid& grid, double isovalue, const PieceChoice& choice) {
  ConnectedRuns runs(grid, isovalue);
  const std::vector<std::size_t> sizes = runs.sizes();
  const auto largest = static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  const double voxel_mm3 = grid.geometry().voxel_volume_mm3();
  const auto is_kept = [&](std::size_t piece) {
    return (!choice.only_largest || piece == largest) &&
           static_cast<double>(sizes[piece]) * voxel_mm3 >= choice.min_mm3;
  };
  PiecesLeftOut result;
  for (std::size_t piece = 0; piece < sizes.size(); ++piece) {
    if (sizes[piece] == 0) continue;
    ++(is_kept(piece) ? result.kept : result.pieces);
    if (!is_kept(piece)) result.voxels += sizes[piece];
  }
  VoxelBox rows = grid.geometry().all_voxels();
  rows.last.i = 0;
  for_each_with_progress(rows, [&](const VoxelIndex& row) {
    runs.for_each_in_row(row.j, row.k, [&](const Run& run, std::size_t piece) {
      if (is_kept(piece)) return;
      for (int i = run.first; i <= run.last; ++i) grid.set({i, row.j, row.k}, grid.outside_density());
    });
  });
  return result;
}

}  // namespace osteomill
