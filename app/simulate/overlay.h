#pragma once

#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Scale bar and orientation letters over the picture.
void draw_annotations(const ViewState& view, const PixelSize& size, bool patient);

/// How everything is done, over everything, until it is sent away.
void draw_help(ViewState& view, const PixelSize& size);

/// A dialogue with what went wrong, until it is sent away.
void draw_complaint(ViewState& view);

/// Asks whether to make the report before the window closes.
void draw_closing(ViewState& view);

/// In the middle of an empty window, or above the bone that is milled meanwhile: how far opening a scan is.
/// True when it is to be given up.
bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above);

}  // namespace osteomill::app
