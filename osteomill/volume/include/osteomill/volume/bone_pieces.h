#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/volume/density_block.h"
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

/// One of a bone's pieces, and the sizes of all.
struct BonePiece {
  std::size_t voxels = 0;
  /// The least box that holds it.
  VoxelBox box;
  /// How many voxels each piece of the bone has, the largest first.
  std::vector<std::size_t> sizes;
};

/// Returns the piece that a voxel of the grid belongs to; nothing if the voxel is no bone. Long work
/// (WorkProgress).
std::optional<BonePiece> piece_at(const DensityGrid& grid, double isovalue, const VoxelIndex& voxel);

/// Names pieces that are to be removed from a bone.
struct PieceRemoval {
  enum class Which : unsigned char { chosen, all_but_chosen, smaller };
  Which which = Which::chosen;
  /// A voxel of the chosen piece.
  VoxelIndex voxel = {};
  /// With `smaller`, the volume from which on pieces stay, mm^3.
  double min_mm3 = 0;
};

/// Returns the bricks that the removal changes, as they are after it: the removed voxels have the least
/// density of the grid, as after leave_out_pieces. Throws std::invalid_argument if no bone is at the voxel of
/// the chosen piece, and std::length_error for more bricks than `max_bricks`. Long work (WorkProgress).
std::vector<DensityBlock> bricks_without(const DensityGrid& grid, double isovalue,
                                         const PieceRemoval& removal, std::size_t max_bricks);

}  // namespace osteomill
