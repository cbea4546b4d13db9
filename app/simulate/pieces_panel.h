#pragma once

#include <future>
#include <optional>

#include "osteomill/visual/camera.h"
#include "osteomill/volume/bone_pieces.h"

#include "app/simulate/bone_view.h"

namespace osteomill::app {

struct Simulation;
struct ViewState;

/// The piece of bone that was clicked on, and what is asked to be removed.
struct ChosenPiece {
  /// The next click on bone chooses a piece.
  bool choosing = false;
  /// A voxel of the piece, from when it was chosen until its menu is closed.
  std::optional<VoxelIndex> voxel;
  /// Its volume, which another thread finds out.
  std::optional<BonePiece> piece;
  std::future<std::optional<BonePiece>> pending;
  /// The volume up to which pieces count as small, mm^3.
  float min_mm3 = 10;
  /// The removal that waits until nothing else is being prepared.
  std::optional<PieceRemoval> requested;
  /// The box of all bone, which another thread finds out after a change.
  std::future<BoneBox> box;

  bool is_settled() const { return !requested && !pending.valid() && !box.valid(); }
};

/// Begins to measure what bone is left, which the view then shows as the whole.
void measure_bone(ChosenPiece& chosen, const Simulation& simulation);

/// Draws the button that chooses a piece, in the column on the left.
void draw_piece_controls(ViewState& view, const Simulation& simulation);

/// Takes a click with the right button on bone, or with the left one once the button was pressed, and draws
/// the menu of the piece that was clicked on, with a box around it.
void draw_piece_menu(ViewState& view, Simulation& simulation, const PixelSize& size);

}  // namespace osteomill::app
