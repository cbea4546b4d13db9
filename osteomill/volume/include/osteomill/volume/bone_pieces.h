#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/density_grid.h"

/// Connected components ("pieces") of the bone, such as a scanned head and the table under it. All functions
/// pass over the whole grid; not for the tick.
namespace osteomill {

/// Selects pieces to keep, by size. Keeps all by default.
struct PieceChoice {
  bool only_largest = false;
  /// Minimum volume of a piece to keep.
  double min_mm3 = 0;

  bool keeps_all() const { return !only_largest && min_mm3 <= 0; }
};

/// Returns the fields of PieceChoice: --keep-largest and --min-piece.
template <>
const std::vector<Field<PieceChoice>>& fields_of<PieceChoice>();

/// Returns the voxel count of each piece of bone, largest first. Uses 26-connectivity: voxels above the
/// isovalue that share a face, an edge or a corner belong to one piece, because the isosurface may join them.
/// Long work (WorkProgress).
std::vector<std::size_t> piece_sizes(const DensityGrid& grid, double isovalue);

/// The result of discard_pieces.
struct DiscardedPieces {
  std::size_t pieces = 0;
  std::size_t voxels = 0;
  /// Number of pieces kept.
  std::size_t kept = 0;
};

/// Sets the voxels of all pieces that `choice` does not keep to the grid's lowest density. If several pieces
/// are equally large, the one with the lowest voxel index counts as the largest. Long work (WorkProgress).
DiscardedPieces discard_pieces(DensityGrid& grid, double isovalue, const PieceChoice& choice);

/// One piece of a bone, and the sizes of all pieces.
struct BonePiece {
  std::size_t voxels = 0;
  /// Bounding box of the piece.
  VoxelBox box;
  /// Voxel count of each piece of the bone, largest first.
  std::vector<std::size_t> sizes;
};

/// Returns the piece that a voxel of the grid belongs to; nullopt if the voxel is not bone. Long work
/// (WorkProgress).
std::optional<BonePiece> piece_at(const DensityGrid& grid, double isovalue, const VoxelIndex& voxel);

/// Selects pieces to remove from a bone.
struct PieceRemoval {
  enum class Which : unsigned char { chosen, all_but_chosen, smaller };
  Which which = Which::chosen;
  /// A voxel of the chosen piece.
  VoxelIndex voxel = {};
  /// For `smaller`: pieces below this volume are removed, mm^3.
  double min_mm3 = 0;
};

/// Returns the bricks that the removal changes, in their state after it: removed voxels have the grid's
/// lowest density, as after discard_pieces. Throws std::invalid_argument if the chosen voxel is not bone,
/// and std::length_error for more bricks than `max_bricks`. Long work (WorkProgress).
std::vector<DensityBlock> bricks_without(const DensityGrid& grid, double isovalue,
                                         const PieceRemoval& removal, std::size_t max_bricks);

}  // namespace osteomill
