#pragma once

#include <optional>
#include <string>

#include "osteomill/session/space_mouse.h"
#include "osteomill/visual/spindle_sound.h"

#include "app/simulate/dialogues.h"
#include "app/simulate/files_panel.h"
#include "app/simulate/gamepad.h"
#include "app/simulate/playback.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Hints of controls that several panels have.
inline constexpr const char* kWholeHint = "Shows all of the bone from the same side";
inline constexpr const char* kStartPageHint =
    "Closes this bone and shows the exercises and scans to begin with";
inline constexpr const char* kGhostHint = "Shows in blue where your hand is if bone holds the tool back";
inline constexpr const char* kSeeThroughHint =
    "Shows the tool through bone that lies between you and the burr (key X)";
inline constexpr const char* kArrowsHint =
    "Shows the force on your hand as a green arrow and the torque as an amber one";

/// The column on the left: everything that can be set.
void draw_controls(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size);

/// Asks for the tool that is remembered, if it can work with the bone.
void recall_tool(ViewState& view);

/// The free part of the right column, pixels from the top.
struct VerticalSpan {
  float top_px;
  float bottom_px;
};

/// The right column: everything that is measured, and if hardware holds the tool, how that is. Returns
/// where the next thing below has room.
float draw_readings(ViewState& view, Simulation& simulation, double pictures_per_s, const PixelSize& size);

/// Below it, if the bone has labels: a legend, and how much of each was removed; what has no room is
/// scrolled to.
float draw_labels(ViewState& view, const Simulation& simulation, const VerticalSpan& span);

/// Below all of that, until it is sent away: how everything is done.
void draw_help(ViewState& view, const PixelSize& size, const VerticalSpan& span);

/// While the burr touches a no-go label and some seconds after: a red line across the top that says so.
void draw_no_go(Simulation& simulation);

/// Scale bar and orientation letters over the picture.
void draw_annotations(const ViewState& view, const PixelSize& size, bool patient);

/// While the tool is in the hand, how it is let go, at the lower edge.
void draw_hand(const ViewState& view);

/// A red badge with how long a recording has been going on.
std::string recording_text(double recording_s);
void draw_recording(double recording_s);

/// The popup in which a scan is chosen.
inline constexpr const char* kOpenPopup = "Open a scan###open";
/// Returns whether a dialogue is open, which alone takes pointer and keys then.
bool is_dialogue_open();
/// The dialogue that is to be seen, if any. Takes down what is chosen.
void draw_dialogue(DialogueQueue& dialogues);

/// Draws the progress of opening a scan, in the middle of an empty window or above the bone that is milled
/// meanwhile. Returns true if the user cancels it.
bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above);

/// Takes what mouse, keyboard, SpaceMouse and game controller did since the last picture to the camera and
/// the tool, as the help tells.
void take_input(ViewState& view, Simulation& simulation, SpaceMouse& space_mouse, Gamepad& gamepad,
                const PixelSize& size);

/// Takes what the pointer did since the last picture to the camera alone.
void take_view_input(ViewState& view, const PixelSize& size);

/// The recording that is played: what its tick holds, the time line, and buttons for all that can be done.
void draw_playback(ViewState& view, Playback& playback, const PixelSize& size);

/// Brings the tool out of bone that came back (a cut undone, another isovalue), or if it grew while it was in
/// a hole: puts it before the bone where it is seen. Does nothing to a tool that only presses on bone.
void free_tool(ViewState& view, Simulation& simulation, const PixelSize& size);

/// The option that the slider of stiffness sets; and the value in force, which is nothing if the algorithm
/// has no such setting.
inline constexpr const char* kStiffnessOption = "stiffness";
std::optional<double> stiffness_of(const MillingSetup& setup);

/// Returns where the isovalue in force came from.
std::string isovalue_text(const Simulation& simulation);

}  // namespace osteomill::app
