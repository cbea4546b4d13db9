#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <GLFW/glfw3.h>
#include <imgui.h>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/session/milling_entry.h"

#include "app/simulate/panels.h"
#include "app/simulate/tool_control.h"
#include "app/simulate/view_aids_panel.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr double kPointerReach_px = 12;
constexpr double kTouching_N = 0.15;
constexpr int kSteps = 100;
// Time in which a released tool comes to rest; two or three frames suffice on an idle machine.
constexpr double kRelaxing_s = 1;

bool is_key_down(int key) {
  return ImGui::IsKeyDown(key);
}

double key_axis(int forwards, int backwards) {
  return (is_key_down(forwards) ? 1.0 : 0.0) - (is_key_down(backwards) ? 1.0 : 0.0);
}

// Returns the key input equivalent to the wheel, which also works while a button is pressed; W and S are on
// every keyboard.
double away_axis() {
  const double letters = ImGui::GetIO().KeyCtrl ? 0 : key_axis(GLFW_KEY_W, GLFW_KEY_S);
  return std::clamp(key_axis(GLFW_KEY_PAGE_UP, GLFW_KEY_PAGE_DOWN) + letters, -1.0, 1.0);
}

// Returns the pointer motion since the last frame.
Eigen::Vector2d pointer_moved_px() {
  const ImVec2 moved = ImGui::GetIO().MouseDelta;
  return {static_cast<double>(moved.x), static_cast<double>(moved.y)};
}

// Returns the motion of a drag. Zero in the frame in which the button was pressed, because the pointer may
// have moved far before that.
Eigen::Vector2d pointer_dragged_px() {
  const bool just_pressed = ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2);
  return just_pressed ? Eigen::Vector2d::Zero() : pointer_moved_px();
}

// Returns the first cut along the line of sight through a pixel, within the bounds of the bone.
std::optional<std::size_t> cut_under(const ViewState& view, const PixelSize& size, double x_px, double y_px) {
  const Vec3 ray = ray_through(view.camera, size, x_px, y_px);
  const Vec3 eye = view.camera.eye_W();
  const Sphere bounds = view.box.bounds();
  double nearest_mm = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> found;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    const ViewState::SectionPlane& cut = view.cuts[n];
    const double towards = ray.dot(cut.normal_W);
    if (!cut.on || std::abs(towards) < 1e-6) continue;
    const double along_mm = (static_cast<double>(cut.offset_mm) - cut.normal_W.dot(eye)) / towards;
    const Vec3 point_W = eye + along_mm * ray;
    if (along_mm <= 0 || along_mm > nearest_mm) continue;
    if ((point_W - bounds.centre_W).norm() > 1.1 * bounds.radius_mm) continue;
    nearest_mm = along_mm;
    found = n;
  }
  return found;
}

// Moves the cut under the pointer along its normal while Ctrl and the left button are pressed. Returns
// whether it is dragging.
bool drag_cut(ViewState& view, const PixelSize& size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsMouseClicked(0) && io.KeyCtrl && !io.WantCaptureMouse) {
    const auto under =
        cut_under(view, size, static_cast<double>(io.MousePos.x), static_cast<double>(io.MousePos.y));
    view.dragged_cut = under ? static_cast<int>(*under) : -1;
  }
  if (!io.MouseDown[0]) view.dragged_cut = -1;
  if (view.dragged_cut < 0) return false;
  ViewState::SectionPlane& cut = view.cuts[static_cast<std::size_t>(view.dragged_cut)];
  // Projected normal, px/mm. A cut that faces the viewer hardly moves in the picture; dragging upwards then
  // moves it along its normal.
  const Vec3 anchor_W = view.box.centre_W();
  Eigen::Vector2d normal_px =
      pixel_of(view.camera, size, anchor_W + cut.normal_W) - pixel_of(view.camera, size, anchor_W);
  const double full = 1 / mm_per_pixel(view.camera, size, depth_of(view.camera, anchor_W));
  if (normal_px.norm() < 0.2 * full) normal_px = Eigen::Vector2d(0, -full);
  cut.offset_mm += static_cast<float>(pointer_dragged_px().dot(normal_px) / normal_px.squaredNorm());
  return true;
}

// Changes window and level of all cuts while Ctrl and the right button are pressed on a cut. Returns whether
// it is dragging.
bool drag_grey(ViewState& view, const WindowLevel& first, const PixelSize& size) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsMouseClicked(1) && io.KeyCtrl && !io.WantCaptureMouse)
    view.dragging_grey =
        cut_under(view, size, static_cast<double>(io.MousePos.x), static_cast<double>(io.MousePos.y))
            .has_value();
  if (!io.MouseDown[1]) view.dragging_grey = false;
  if (!view.dragging_grey) return false;
  const Eigen::Vector2d dragged_px = pointer_dragged_px();
  view.grey_window = dragged_grey(view.grey_window.value_or(first), dragged_px.x(), dragged_px.y());
  return true;
}

// Returns whether the pointer is on the tool.
bool on_tool(const ViewState& view, const Pose& X_WT, const MillingTool& tool, const PixelSize& size,
             const ImVec2& pointer) {
  const Vec3 ray =
      ray_through(view.camera, size, static_cast<double>(pointer.x), static_cast<double>(pointer.y));
  const Pose X_TW = X_WT.inverse();
  const double middle_mm = depth_of(view.camera, X_WT.position_mm);
  const double reach_mm = kPointerReach_px * mm_per_pixel(view.camera, size, middle_mm);
  for (int n = 0; n <= kSteps; ++n) {
    const double along_mm = middle_mm + tool.shaft_length_mm * (2.0 * n / kSteps - 1.0);
    const Vec3 point_W = view.camera.eye_W() + along_mm * ray;
    if (tool_distance(tool, X_TW * point_W).distance_mm < reach_mm) return true;
  }
  return false;
}

void move_camera(ViewState& view, const PixelSize& size, bool left_is_tool) {
  const ImGuiIO& io = ImGui::GetIO();
  const Eigen::Vector2d dragged_px = pointer_dragged_px();
  const double right_px = dragged_px.x();
  const double down_px = dragged_px.y();
  const bool left = io.MouseDown[0] && !left_is_tool;
  if (io.MouseDown[2] || (left && io.KeyShift)) {
    pan(view.camera, size, right_px, down_px);
  } else if (left) {
    turn(view.camera, size, right_px, down_px);
  } else if (io.MouseDown[1]) {
    zoom_by_drag(view.camera, size, down_px);
  }
  if (!view.holding_tool && io.MouseWheel != 0)
    zoom_by_wheel(view.camera, static_cast<double>(io.MouseWheel));
}

ToolInput keys_for_tool() {
  ToolInput input;
  const ImGuiIO& io = ImGui::GetIO();
  input.turning = io.KeyShift;
  input.passed_s = static_cast<double>(io.DeltaTime);
  if (io.WantTextInput) return input;
  input.keys = {key_axis(GLFW_KEY_RIGHT, GLFW_KEY_LEFT), key_axis(GLFW_KEY_UP, GLFW_KEY_DOWN), away_axis()};
  return input;
}

void take_view_keys(ViewState& view) {
  if (!ImGui::GetIO().WantTextInput && ui::is_key_pressed(GLFW_KEY_X)) view.see_through = !view.see_through;
}

void take_keys(ViewState& view, LiveMilling& milling, bool by_pointer) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput) return;
  using ui::is_key_pressed;
  if (is_key_pressed(GLFW_KEY_T) && by_pointer) view.holding_tool = !view.holding_tool;
  if (is_key_pressed(GLFW_KEY_ESCAPE)) view.holding_tool = false;
  if (is_key_pressed(GLFW_KEY_SPACE)) milling.set_spindle(!milling.is_spindle_requested());
  if (is_key_pressed(GLFW_KEY_P)) milling.set_paused(!milling.state().record.paused);
  if (is_key_pressed(GLFW_KEY_F1)) view.help = !view.help;
  if (is_key_pressed(GLFW_KEY_F11)) view.full_screen_requested = true;
  const bool z = io.KeyCtrl && is_key_pressed(GLFW_KEY_Z), y = io.KeyCtrl && is_key_pressed(GLFW_KEY_Y);
  if (z && !io.KeyShift && milling.follower().cuts() > 0) view.undo_requested = true;
  if ((y || (z && io.KeyShift)) && milling.follower().undone_cuts() > 0) view.redo_requested = true;
}

// Moves the tool in front of the bone visible at the pixel, or else at the centre of the view.
void move_tool_to_bone(ViewState& view, Simulation& simulation, const PixelSize& size,
                       const std::optional<Eigen::Vector2d>& pixel) {
  LiveMilling& milling = simulation.milling;
  const MillingTool& tool = milling.setup().tool;
  milling.set_spindle(false);
  milling.follower().read([&](const Volume& bone) {
    if (pixel)
      view.X_W_destination = tool_pose_in_front_of(bone, tool, view.camera, size, pixel->x(), pixel->y());
    if (!view.X_W_destination) view.X_W_destination = tool_pose_at_centre(bone, tool, view.camera, size);
  });
  milling.place(*view.X_W_destination);
}

void pull_tool(ViewState& view, Simulation& simulation, const ToolInput& input, const PixelSize& size) {
  if (view.X_W_destination) {
    if (simulation.milling.is_placing()) return;
    view.X_W_target = *std::exchange(view.X_W_destination, std::nullopt);
  }
  if (!simulation.tool_source.is_pointer()) return;
  const Pose& X_WD = simulation.milling.state().record.X_WD;
  view.X_W_target = moved_target(view.X_W_target, X_WD, view.camera, size, input);
  simulation.hand.pull_to(view.X_W_target);
}

bool is_pushed(const ToolInput& input) {
  return !input.keys.isZero() || !input.space_mouse.push.isZero() || !input.space_mouse.twist.isZero();
}

// If the tool is no longer held or pushed, moves the hand's target to the tool's pose, so that it stops
// pressing. Continues for a moment, because bone then pushes the resting tool out by its last bit of
// penetration. Only the first step is done while the burr is turning, which would walk away with the hand.
void release_hand_at_rest(ViewState& view, Simulation& simulation, const ToolInput& input) {
  const bool held = view.holding_tool || view.dragging_tool;
  // A turning burr would continue to mill.
  if (std::exchange(view.was_held, held) && !held) simulation.milling.set_spindle(false);
  if (held || is_pushed(input)) view.yield_time_left_s = kRelaxing_s;
  if (held || is_pushed(input) || view.yield_time_left_s <= 0 || view.X_W_destination) return;
  const bool has_just_ended = view.yield_time_left_s == kRelaxing_s;
  view.yield_time_left_s -= input.passed_s;
  const TickRecord& record = simulation.milling.state().record;
  if (!simulation.tool_source.is_pointer() || (!has_just_ended && record.spindle_rpm > 0)) return;
  view.X_W_target = record.X_WT;
  simulation.hand.pull_to(view.X_W_target);
}

void release_buttons(ViewState& view, LiveMilling& milling) {
  if (view.pedal_down) milling.set_spindle(false);
  view.pedal_down = view.dragging_tool = view.dragging_view = false;
}

// Applies the buttons of a game controller; returns the motion it commands.
SpaceMouseState take_gamepad(const GamepadInput& input, ViewState& view, LiveMilling& milling) {
  if (input.is_mill_pressed) milling.set_spindle(view.pedal_down = true);
  if (input.is_undo && milling.follower().cuts() > 0) view.undo_requested = true;
  return input.motion;
}

// Handles releases, whatever else handles the input of this frame.
void take_releases(const GamepadInput& gamepad, ViewState& view, LiveMilling& milling) {
  if (gamepad.is_release_pressed) view.holding_tool = false;
  if (gamepad.is_release_pressed) milling.set_spindle(false);
  if (gamepad.is_mill_released || ImGui::IsMouseReleased(0) || is_dialogue_open())
    release_buttons(view, milling);
}

}  // namespace

void take_input(ViewState& view, Simulation& simulation, SpaceMouse& space_mouse, Gamepad& gamepad,
                const PixelSize& size) {
  const GamepadInput by_gamepad = gamepad.read();
  take_releases(by_gamepad, view, simulation.milling);
  if (is_dialogue_open() || drag_cut(view, size) || drag_grey(view, simulation.scan.grey_window, size)) {
    release_hand_at_rest(view, simulation, {.passed_s = static_cast<double>(ImGui::GetIO().DeltaTime)});
    return;
  }
  const ImGuiIO& io = ImGui::GetIO();
  LiveMilling& milling = simulation.milling;
  const LiveState& state = milling.state();
  const MillingTool& tool = milling.setup().tool;
  if (ImGui::IsMouseClicked(0)) {
    const bool on_picture = !io.WantCaptureMouse;
    view.dragging_tool = on_picture && !view.holding_tool && !io.KeyShift &&
                         simulation.tool_source.is_pointer() &&
                         on_tool(view, state.record.X_WT, tool, size, io.MousePos);
    view.dragging_view = on_picture && !view.dragging_tool && !view.holding_tool;
    view.pedal_down = on_picture && view.holding_tool;
    if (view.pedal_down) milling.set_spindle(true);
  }
  const bool on_picture = !io.WantCaptureMouse || view.dragging_view || view.dragging_tool;
  if (on_picture) move_camera(view, size, !view.dragging_view);

  ToolInput input = keys_for_tool();
  input.space_mouse = space_mouse.read();
  const SpaceMouseState also = take_gamepad(by_gamepad, view, milling);
  input.space_mouse.push += also.push;
  input.space_mouse.twist += also.twist;
  if (input.space_mouse.presses % 2 == 1) milling.set_spindle(!milling.is_spindle_requested());
  input.touching = state.record.wrench.force_N.norm() > kTouching_N;
  if (on_picture && (view.holding_tool || view.dragging_tool) && !io.MouseDown[1] && !io.MouseDown[2]) {
    input.moved_px = view.holding_tool ? pointer_moved_px() : pointer_dragged_px();
  }
  if (on_picture && view.holding_tool) input.wheel = static_cast<double>(io.MouseWheel);
  release_hand_at_rest(view, simulation, input);
  pull_tool(view, simulation, input, size);
  if (ConnectedDevice* hardware = simulation.tool_source.hardware) {
    hardware->set_view(view.camera.orientation);
    const bool clutched = !io.WantTextInput && is_key_down(GLFW_KEY_C);
    hardware->set_clutched(clutched || view.calibration.step != ViewState::Calibration::Step::none);
  }
  take_view_keys(view);
  take_keys(view, milling, simulation.tool_source.is_pointer());
  const bool by_key = !io.WantTextInput && ui::is_key_pressed(GLFW_KEY_B);
  if ((std::exchange(view.bring_requested, false) || by_key) && !milling.is_placing()) {
    std::optional<Eigen::Vector2d> pointer;
    if (by_key && !io.WantCaptureMouse)
      pointer = {static_cast<double>(io.MousePos.x), static_cast<double>(io.MousePos.y)};
    move_tool_to_bone(view, simulation, size, pointer);
  }
}

void take_view_input(ViewState& view, const PixelSize& size) {
  take_view_keys(view);
  const bool on_picture = !ImGui::GetIO().WantCaptureMouse;
  view.holding_tool = view.dragging_tool = false;
  if (ImGui::IsMouseClicked(0)) view.dragging_view = on_picture;
  if (ImGui::IsMouseReleased(0)) view.dragging_view = false;
  if (on_picture || view.dragging_view) move_camera(view, size, !view.dragging_view);
}

void move_tool_out_of_bone(ViewState& view, Simulation& simulation, const PixelSize& size) {
  const Pose X_WT = simulation.milling.state().record.X_WT;
  // A tool that only presses on bone keeps this core out of it.
  MillingTool core = simulation.milling.setup().tool;
  core.burr_radius_mm *= 0.5;
  core.shaft_radius_mm *= 0.5;
  bool free = true;
  simulation.milling.follower().read([&](const Volume& bone) { free = tool_is_free(bone, core, X_WT); });
  if (!free) move_tool_to_bone(view, simulation, size, pixel_of(view.camera, size, X_WT.position_mm));
  // An enlarged burr would press where it was released.
  view.yield_time_left_s = kRelaxing_s;
}

}  // namespace osteomill::app
