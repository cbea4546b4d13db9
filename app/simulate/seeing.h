#pragma once

#include <optional>

#include "osteomill/visual/scene.h"
#include "osteomill/volume/volume.h"

#include "app/simulate/view_state.h"

namespace osteomill::app {

class BoneScene;
class FilesPanel;
struct Simulation;

/// Returns the point of bone that is seen at a pixel, on the surface or on a cut; nothing if no bone is.
std::optional<Vec3> bone_point_seen(const Volume& bone, const ViewState& view, const PixelSize& size,
                                    double x_px, double y_px);

/// Takes the keys and clicks that are for seeing: follow the burr, loupe, measuring. Call once for each
/// picture.
void update_seeing(ViewState& view, Simulation& simulation, const PixelSize& size);

/// Draws the loupe into the window, and landmarks and distances over the picture.
void draw_seen(const ViewState& view, const ViewScene& scene, BoneScene& bone, const PixelSize& size);

/// Draws the controls for all of that, within the group View.
void draw_seeing(ViewState& view, const FilesPanel& files);

/// Draws window and level of the cuts, within the group Cuts.
void draw_grey(ViewState& view, const WindowLevel& first);

}  // namespace osteomill::app
