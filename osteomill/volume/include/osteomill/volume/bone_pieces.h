#pragma once

#include <cstddef>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/volume/density_grid.h"

/// The connected pieces of a bone: a scanned head and the table it lies on. Passes over the voxels; not for
/// the tick.
namespace osteomill {

/// Chooses pieces by their size. By default all are kept.
struct PieceChoice {
  bool only_largest = false;
  /// Smaller pieces are left out.
  double min_mm3 = 0;

  bool keeps_all() const { return !only_largest && min_mm3 <= 0; }
};

/// Returns the fields of the choice: --keep-largest and --min-piece.
template <>
const std::vector<Field<PieceChoice>>& fields_of<PieceChoice>();

/// Returns how many voxels each piece of bone has, the largest first. Voxels whose density is above the
/// isovalue belong to one piece if they share a face, an edge or a corner: a surface between them may join
/// them, so that no piece is ever cut in two. Long work (WorkProgress).
std::vector<std::size_t> piece_sizes(const DensityGrid& grid, double isovalue);

/// The result of leave_out_pieces.
struct PiecesLeftOut {
  std::size_t pieces = 0;
  std::size_t voxels = 0;
  /// The pieces that stay.
  std::size_t kept = 0;
};

/// Gives the voxels of all pieces that `choice` does not keep the least density of the grid. Of several
/// largest pieces of one size the one with the lowest voxel number stays. Long work (WorkProgress).
PiecesLeftOut leave_out_pieces(DensityGrid& grid, double isovalue, const PieceChoice& choice);

}  // namespace osteomill
