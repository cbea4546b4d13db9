#pragma once

#include <exception>
#include <memory>
#include <string>

#include "osteomill/openigtlink/bone_sender.h"
#include "osteomill/session/space_mouse.h"

#include "app/device_option.h"
#include "app/simulate/gamepad.h"
#include "app/simulate/simulation.h"
#include "app/simulate/stage.h"

namespace osteomill::app {

/// Returns the pose in which the tool of a scan begins: before the bone in the middle of the view, or as it
/// was in the recording that is milled on from.
Pose first_tool_pose(const PreparedScan& opened, const Camera& camera, const PixelSize& size);

/// A scan in the window while it is milled, with the panels about it. One at a time on a stage.
class MillingScreen {
 public:
  /// Begins to tick with the tool at `X_WT`, and sends the bone if that was asked for.
  MillingScreen(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source,
                const std::string& command_line, const SendOption& send, Stage& stage);

  Simulation& simulation() { return simulation_; }
  /// Does the work of one picture, and draws it.
  void draw(Stage& stage);
  /// Returns the bone and tool from this camera, in full detail.
  Image picture(const Camera& camera, Stage& stage);
  /// Returns whether nothing that was asked for is still being prepared.
  bool is_settled(const Stage& stage);

 private:
  void begin_view(Stage& stage);
  void start_requests(ViewState& view);
  void update(Stage& stage);
  void report_device_failure(ViewState& view);
  void save_picture(Stage& stage);
  void draw_panels(Stage& stage);
  void set_sound(Stage& stage);

  Simulation simulation_;
  // True from when an exercise was opened until it is recorded.
  bool exercise_begins_ = false;
  SpaceMouse space_mouse_;
  Gamepad gamepad_;
  // The failure that the user was told of.
  std::exception_ptr device_failure_;
  std::unique_ptr<BoneSender> sender_;
};

}  // namespace osteomill::app
