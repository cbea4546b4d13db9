#pragma once

#include <string>

#include "app/simulate/dialogues.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Scale bar and orientation letters over the picture.
void draw_annotations(const ViewState& view, const PixelSize& size, bool patient);

/// A red badge with how long a recording has been going on.
std::string recording_text(double recording_s);
void draw_recording(double recording_s, const PixelSize& size);

/// Whether a dialogue is seen, so that pointer and keys are nobody else's.
bool dialogue_open();
/// The dialogue that is to be seen, if any. Takes down what is chosen.
void draw_dialogue(DialogueQueue& dialogues);

/// In the middle of an empty window, or above the bone that is milled meanwhile: how far opening a scan is.
/// True when it is to be given up.
bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above);

}  // namespace osteomill::app
