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

/// Returns the initial tool pose for a scan: in front of the bone at the centre of the view, or the pose in
/// the recording that is continued.
Pose initial_tool_pose(const PreparedScan& opened, const Camera& camera, const PixelSize& size);

/// A scan being milled in the window, with its panels. Only one at a time on a stage.
class MillingScreen {
 public:
  /// Starts ticking with the tool at `X_WT`, and sends the bone if `send` requests it.
  MillingScreen(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source,
                const std::string& command_line, const SendOption& send, Stage& stage);

  Simulation& simulation() { return simulation_; }
  /// Processes and draws one frame.
  void draw(Stage& stage);
  /// Renders bone and tool from this camera, in full detail.
  Image picture(const Camera& camera, Stage& stage);
  /// Returns whether no request is pending.
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
  // From opening an exercise until its recording starts.
  bool exercise_begins_ = false;
  SpaceMouse space_mouse_;
  Gamepad gamepad_;
  // The failure already reported to the user.
  std::exception_ptr device_failure_;
  std::unique_ptr<BoneSender> sender_;
};

}  // namespace osteomill::app
