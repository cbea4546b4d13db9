#pragma once

#include "app/simulate/files_panel.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Draws the task, the step, the distance, the burrs and the time between the two columns, and once the
/// exercise is finished its results. Takes the keys G (guidance) and M (beat). Does nothing without an
/// exercise.
void draw_exercise(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size);

/// Ends the recording, and begins to measure it. Not while another one is measured.
void finish_exercise(ViewState& view, Simulation& simulation, FilesPanel& files);

/// Returns the text on the nearest structure: "facial nerve 2.3 mm"; empty without structures or guidance.
std::string distance_text(const Simulation& simulation, const TickRecord& record);

}  // namespace osteomill::app
