#pragma once

#include <future>
#include <optional>

#include "osteomill/visual/camera.h"
#include "osteomill/volume/bone_pieces.h"

#include "app/simulate/bone_view.h"

namespace osteomill::app {

struct Simulation;
struct ViewState;

/// The selected piece of bone, and the requested removal.
struct ChosenPiece {
  /// The next click on bone selects a piece.
  bool choosing = false;
  /// A voxel of the piece, from its selection until its menu is closed.
  std::optional<VoxelIndex> voxel;
  /// The piece and its volume, computed by another thread.
  std::optional<BonePiece> piece;
  std::future<std::optional<BonePiece>> pending;
  /// Volume below which pieces count as small, mm^3.
  float min_mm3 = 10;
  /// The removal that waits until no preparation is under way.
  std::optional<PieceRemoval> requested;
  /// Bounding box of the bone, recomputed by another thread after a change.
  std::future<BoneBox> box;

  bool is_settled() const { return !requested && !pending.valid() && !box.valid(); }
};

/// Starts measuring the remaining bone, which the view then treats as the whole.
void measure_bone(ChosenPiece& chosen, const Simulation& simulation);

/// Draws the button for selecting a piece, in the left column.
void draw_piece_controls(ViewState& view, const Simulation& simulation);

/// Handles a right click on bone, or a left click after the button was pressed, and draws the menu of the
/// selected piece with a box around it.
void draw_piece_menu(ViewState& view, Simulation& simulation, const PixelSize& size);

}  // namespace osteomill::app
