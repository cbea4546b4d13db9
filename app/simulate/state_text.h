#pragma once

#include <optional>
#include <string>

#include "app/simulate/files_panel.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

#include "osteomill/sound/spindle_sound.h"

namespace osteomill::app {

/// What the window's controls bring about, a line "NAME.KEY=VALUE" each: not how a control stands but what is
/// in force, is drawn and is heard. For scripts (ui_script.h).
std::string state_text(const std::string& name, const ViewState& view, Simulation& simulation,
                       const FilesPanel& files, const SpindleState& heard, const PixelSize& size);

/// What the slider of stiffness sets, in force: nothing where the algorithm has none.
inline constexpr const char* kStiffnessOption = "stiffness";
std::optional<double> stiffness_of(const MillingSetup& setup);

/// Where the isovalue in force came from.
std::string isovalue_text(const Simulation& simulation);

}  // namespace osteomill::app
