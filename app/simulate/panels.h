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

/// Hints of controls that appear in several panels.
inline constexpr const char* kWholeHint = "Fits the whole bone into the view, from the same side";
inline constexpr const char* kStartPageHint =
    "Closes this bone and shows the start page with exercises and scans";
inline constexpr const char* kGhostHint = "Shows your hand in blue when bone holds the tool back";
inline constexpr const char* kSeeThroughHint = "Makes bone in front of the burr translucent (X)";
inline constexpr const char* kArrowsHint =
    "Shows the force on your hand as a green arrow, the torque as an amber one";

/// Draws the left column: all settings.
void draw_controls(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size);

/// Requests the remembered tool if it can work with the bone.
void request_remembered_tool(ViewState& view);

/// Free part of the right column, pixels from the top.
struct VerticalSpan {
  float top_px;
  float bottom_px;
};

/// Draws the right column: all readings, and the state of the device if one holds the tool. Returns the upper
/// edge of the free space below.
float draw_readings(ViewState& view, Simulation& simulation, double frames_per_s, const PixelSize& size);

/// Draws the legend of the labels, if the bone has any, with the removed volume of each; scrolls if there is
/// not enough room.
float draw_labels(ViewState& view, const Simulation& simulation, const VerticalSpan& span);

/// Draws help on all controls below the labels until the user closes it.
void draw_help(ViewState& view, const PixelSize& size, const VerticalSpan& span);

/// Draws a red warning across the top while the burr touches a no-go label, and for some seconds after.
void draw_no_go(Simulation& simulation);

/// Draws scale bar and orientation letters over the picture.
void draw_annotations(const ViewState& view, const PixelSize& size, bool patient);

/// Draws a note at the lower edge on how to release the tool while it is held.
void draw_hand(const ViewState& view);

/// Text and badge with the length of the running recording.
std::string recording_text(double recording_s);
void draw_recording(double recording_s);

/// Title of the popup in which a scan is chosen.
inline constexpr const char* kOpenPopup = "Open a scan###open";
/// Returns whether a dialogue is open; pointer and keys then belong to it alone.
bool is_dialogue_open();
/// Draws the current dialogue, if any, and notes the choice.
void draw_dialogue(DialogueQueue& dialogues);

/// Draws the progress of opening a scan, in the middle of an empty window or above the bone being milled.
/// Returns true if the user cancels.
bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above);

/// Applies the input of mouse, keyboard, SpaceMouse and game controller since the last frame to camera and
/// tool, as described in the help.
void take_input(ViewState& view, Simulation& simulation, SpaceMouse& space_mouse, Gamepad& gamepad,
                const PixelSize& size);

/// Applies the pointer's input since the last frame to the camera only.
void take_view_input(ViewState& view, const PixelSize& size);

/// Draws the panels for playback: the data of the current tick, the time line and the controls.
void draw_playback(ViewState& view, Playback& playback, const PixelSize& size);

/// Moves the tool out of bone that was restored (a cut undone, another isovalue), or out of a hole if it was
/// enlarged: to a pose in front of the bone at the same pixel. Does nothing to a tool that only presses on
/// bone.
void move_tool_out_of_bone(ViewState& view, Simulation& simulation, const PixelSize& size);

/// Option set by the stiffness slider, and its current value; std::nullopt if the algorithm has no such
/// setting.
inline constexpr const char* kStiffnessOption = "stiffness";
std::optional<double> stiffness_of(const MillingSetup& setup);

/// Returns how the current isovalue was determined.
std::string isovalue_text(const Simulation& simulation);

}  // namespace osteomill::app
