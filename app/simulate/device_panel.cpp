#include <algorithm>
#include <exception>
#include <string>

#include "app/simulate/panels.h"
#include "app/simulate/widgets.h"
#include <imgui.h>

#include "osteomill/device/workspace.h"

namespace osteomill::app {

namespace {

using Step = ViewState::Calibration::Step;

void keep_turn(ViewState& view, ConnectedDevice& device, const Vec3& up_D_mm) {
  const DeviceCapabilities& can = device.capabilities();
  const auto turn_deg = turn_by_moves_deg(can, view.calibration.right_D_mm, up_D_mm);
  if (!turn_deg) {
    view.dialogues.complain(
        "The two moves were shorter than 10 mm, or both went the same way. What is known of the device stays "
        "as it was.");
    return;
  }
  WorkspaceSettings settings = device.workspace();
  settings.turn_V_deg = *turn_deg;
  device.set_workspace(settings);
  const std::filesystem::path path = workspace_path(can.name);
  try {
    if (!path.empty()) keep_workspace(path, can.name, settings);
    view.message = "How the device stands before you is kept in " + path.string();
  } catch (const std::exception& error) {
    view.dialogues.complain(error.what());
  }
}

void draw_calibration(ViewState& view, ConnectedDevice& device, const Vec3& handle_D_mm) {
  ViewState::Calibration& calibration = view.calibration;
  if (calibration.step == Step::none) {
    ImGui::SameLine();
    if (ui::button("Calibrate")) calibration = {Step::right, handle_D_mm, Vec3::Zero()};
    ui::hint("Two moves of your hand tell how the device stands before you; the tool stays meanwhile");
    return;
  }
  const bool to_the_right = calibration.step == Step::right;
  ImGui::TextWrapped("%s", to_the_right ? "Move your hand some centimetres to the right, then press"
                                        : "Now move it some centimetres up, then press");
  const bool moved = ui::button(to_the_right ? "That was right" : "That was up");
  ImGui::SameLine();
  if (ui::button("Cancel##calibration")) {
    calibration = {};
  } else if (moved && to_the_right) {
    calibration = {Step::up, handle_D_mm, handle_D_mm - calibration.from_D_mm};
  } else if (moved) {
    keep_turn(view, device, handle_D_mm - calibration.from_D_mm);
    calibration = {};
  }
}

// What lies below does not move as it comes and goes.
void draw_complaint(const std::string& complaint) {
  float& room_px = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("complaint"));
  const float from_px = ImGui::GetCursorPosY();
  ImGui::PushTextWrapPos(0);
  if (!complaint.empty()) ImGui::TextColored(ui::kWarning, "It %s", complaint.c_str());
  ImGui::PopTextWrapPos();
  room_px = std::max(room_px, ImGui::GetCursorPosY() - from_px);
  ImGui::SetCursorPosY(from_px);
  if (room_px > 0) ImGui::Dummy({0, room_px - ImGui::GetStyle().ItemSpacing.y});
}

}  // namespace

void draw_device(ViewState& view, ConnectedDevice& device) {
  ImGui::Separator();
  const DeviceReport report = device.report();
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(device.capabilities().name.c_str());
  ImGui::PopTextWrapPos();
  ImGui::TextDisabled("%.0f poses/s", report.inputs_per_s);
  draw_calibration(view, device, report.handle_D_mm);
  draw_complaint(report.complaint());
}

}  // namespace osteomill::app
