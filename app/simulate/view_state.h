#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/session/milling_setup.h"
#include "osteomill/visual/clip_face.h"
#include "osteomill/visual/scene.h"

#include "app/branch_options.h"
#include "app/simulate/bone_view.h"
#include "app/simulate/dialogues.h"
#include "app/simulate/open_dialog.h"
#include "app/simulate/pieces_panel.h"
#include "app/simulate/preferences.h"
#include "app/simulate/view_aids.h"

namespace osteomill::app {

/// The three planes across the patient and a free one.
inline constexpr std::array<const char*, kMaxClipPlanes> kCutNames{"axial", "coronal", "sagittal", "free"};

/// All that the window shows, and how, beside the simulation itself. What outlives the window is in
/// Preferences.
struct ViewState : Preferences {
  Camera camera;
  BoneBox box;
  Pose X_W_target;
  /// The pose that the tool is brought to, until it is there.
  std::optional<Pose> X_W_destination;
  bool bring_requested = false;
  /// The pointer moves the tool without a button.
  bool holding_tool = false;
  /// Whether the left button drags the tool; decided by the place where it was pressed.
  bool dragging_tool = false;
  /// Whether a hand was on the tool, in either way, in the picture before.
  bool was_held = false;
  /// For how long the hand still gives way since nothing pushed the tool any more.
  double relaxing_s = 0;
  bool dragging_view = false;
  /// The left button is the spindle's pedal as long as it is down.
  bool pedal_down = false;
  /// The progress of the operator in showing by two moves how the device stands; the tool stays meanwhile.
  struct Calibration {
    enum class Step { none, right, up };
    Step step = Step::none;
    Vec3 from_B_mm = Vec3::Zero();
    Vec3 right_B_mm = Vec3::Zero();
  };
  Calibration calibration;
  /// The setup that the controls are set to, and whether milling is still to be changed to it.
  MillingSetup requested_setup;
  bool setup_changed = false;
  /// The number of changes of `requested_setup`.
  int changes = 0;
  bool help = true;
  /// The kind that a button asked to choose for opening, and the scan or recording to be opened.
  OpenKind open_requested = OpenKind::none;
  std::string scan_requested;
  /// The tick of a recording to mill on from, as a button asked for.
  std::optional<BranchOptions> branch_requested;
  /// The exercise to be opened, and whether the start page is to be shown, as a button asked for.
  std::string exercise_requested;
  bool start_page_requested = false;
  /// Whether the exercise is to be finished, as a button asked for.
  bool finish_requested = false;
  /// By how many steps text is to become larger; negative: smaller.
  int text_steps = 0;
  bool reset_requested = false;
  /// Requests that wait until nothing else is being prepared.
  bool undo_requested = false;
  bool redo_requested = false;
  bool reset_confirmed = false;
  std::optional<double> isovalue_requested;
  bool full_screen_requested = false;
  bool picture_requested = false;
  ChosenPiece chosen_piece;
  DialogueQueue dialogues;
  /// The text on what was done last, and the file or folder that it made, if any.
  std::string message;
  std::filesystem::path result;
  /// The page of the report that was made last.
  std::filesystem::path report;

  /// A plane that cuts the bone open: which way it faces and how far along that it lies.
  struct Cut {
    bool on = false;
    bool other_side = false;
    Vec3 normal_W = Vec3::UnitZ();
    float offset_mm = 0;
  };
  std::array<Cut, kMaxClipPlanes> cuts;
  /// Which one the pointer drags, or -1.
  int dragged_cut = -1;
  /// The densities that the cuts draw black and white, if the user has set them, and whether a drag does.
  std::optional<WindowLevel> grey_window;
  bool dragging_grey = false;
  /// A click marks the bone. Each two landmarks in turn are the ends of a distance.
  bool measuring = false;
  std::vector<Landmark> landmarks;
  /// The isovalue that the slider shows while it is moved, and until the bone has it.
  std::optional<float> isovalue;
};

}  // namespace osteomill::app
