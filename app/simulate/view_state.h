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

/// The three anatomical planes and a free one.
inline constexpr std::array<const char*, kMaxClipPlanes> kCutNames{"axial", "coronal", "sagittal", "free"};

/// State of the window besides the simulation itself. State that outlives the window is in Preferences.
struct ViewState : Preferences {
  Camera camera;
  BoneBox box;
  Pose X_W_target;
  /// Pose to which the tool is being moved, until it has arrived.
  std::optional<Pose> X_W_destination;
  bool bring_requested = false;
  /// The pointer moves the tool without a pressed button.
  bool holding_tool = false;
  /// The left button drags the tool; decided by where it was pressed.
  bool dragging_tool = false;
  /// The tool was held, in either way, in the previous frame.
  bool was_held = false;
  /// Time left until the hand stops yielding after the last push, s.
  double yield_time_left_s = 0;
  bool dragging_view = false;
  /// The left button acts as the spindle's pedal while pressed.
  bool pedal_down = false;
  /// Progress of calibrating the device's orientation by two moves; the tool stands still meanwhile.
  struct Calibration {
    enum class Step { none, right, up };
    Step step = Step::none;
    Vec3 from_B_mm = Vec3::Zero();
    Vec3 right_B_mm = Vec3::Zero();
  };
  Calibration calibration;
  /// Setup selected by the controls, and whether it still has to be applied.
  MillingSetup requested_setup;
  bool setup_changed = false;
  /// Number of changes of `requested_setup`.
  int changes = 0;
  bool help = true;
  /// Kind of object that a button requested to open, and the scan or recording to open.
  OpenKind open_requested = OpenKind::none;
  std::string scan_requested;
  /// Requested tick of a recording from which to continue milling.
  std::optional<BranchOptions> branch_requested;
  /// Exercise to open, and whether the start page was requested.
  std::string exercise_requested;
  bool start_page_requested = false;
  /// The user requested to finish the exercise.
  bool finish_requested = false;
  /// Requested steps of text size; negative: smaller.
  int text_steps = 0;
  bool reset_requested = false;
  /// Requests that wait until no preparation is under way.
  bool undo_requested = false;
  bool redo_requested = false;
  bool reset_confirmed = false;
  std::optional<double> isovalue_requested;
  bool full_screen_requested = false;
  bool picture_requested = false;
  ChosenPiece chosen_piece;
  DialogueQueue dialogues;
  /// Message on the last action, and the file or folder it wrote, if any.
  std::string message;
  std::filesystem::path result;
  /// Page of the latest report.
  std::filesystem::path report;

  /// A plane that cuts the bone open: its normal and its offset along that.
  struct SectionPlane {
    bool on = false;
    bool other_side = false;
    Vec3 normal_W = Vec3::UnitZ();
    float offset_mm = 0;
  };
  std::array<SectionPlane, kMaxClipPlanes> cuts;
  /// Cut dragged by the pointer, or -1.
  int dragged_cut = -1;
  /// Densities drawn black and white on the cuts, if the user has set them, and whether a drag is changing
  /// them.
  std::optional<WindowLevel> grey_window;
  bool dragging_grey = false;
  /// A click marks the bone. Each successive pair of landmarks defines a distance.
  bool measuring = false;
  std::vector<Landmark> landmarks;
  /// Isovalue shown by the slider while it is moved, and until the bone has it.
  std::optional<float> isovalue;
};

}  // namespace osteomill::app
