#pragma once

#include <string>

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Scale bar and orientation letters over the picture.
void draw_annotations(const ViewState& view, const PixelSize& size, bool patient);

/// How everything is done, on the right from `top_px` down, until it is sent away.
void draw_help(ViewState& view, const PixelSize& size, float top_px);

/// A red badge with how long a recording has been going on.
std::string recording_text(double recording_s);
void draw_recording(double recording_s, const PixelSize& size);

/// In the middle of an empty window, or above the bone that is milled meanwhile: how far opening a scan is.
/// True when it is to be given up.
bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above);

}  // namespace osteomill::app
