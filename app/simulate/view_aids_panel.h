#pragma once

#include "osteomill/visual/scene.h"

#include "app/simulate/view_state.h"

namespace osteomill::app {

class BoneScene;
class FilesPanel;
struct Simulation;

/// Handles the keys and clicks for viewing: follow the burr, loupe, measuring. Call once per frame.
void update_view_aids(ViewState& view, Simulation& simulation, const PixelSize& size);

/// Draws the loupe into the window, and landmarks and distances over the picture.
void draw_view_aids(const ViewState& view, const ViewScene& scene, BoneScene& bone, const PixelSize& size);

/// Draws the group of controls for viewing.
void draw_view_aid_controls(ViewState& view, const FilesPanel& files);

/// Draws window and level of the cuts, in the group Cuts.
void draw_grey(ViewState& view, const WindowLevel& first);

}  // namespace osteomill::app
