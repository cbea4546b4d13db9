#pragma once

#include "app/simulate/files_panel.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Draws the exercise between the two columns: task, step, distance, burrs and time, and its results once it
/// is finished. Handles the keys G (guidance) and M (beat). Does nothing without an exercise.
void draw_exercise(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size);

/// Ends the recording and starts measuring it. Do not call while another one is being measured.
void finish_exercise(ViewState& view, Simulation& simulation, FilesPanel& files);

/// Returns text on the nearest structure, e.g. "facial nerve 2.3 mm"; empty without structures or guidance.
std::string distance_text(const Simulation& simulation, const TickRecord& record);

}  // namespace osteomill::app
