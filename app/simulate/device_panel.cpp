#include <exception>

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
    view.complaint =
        "The two moves were shorter than 10 mm, or not across each other. The device stays as it was.";
    return;
  }
  WorkspaceSettings settings = device.workspace();
  settings.turn_V_deg = *turn_deg;
  device.set_workspace(settings);
  const std::filesystem::path path = workspace_path(can.name);
  try {
    if (!path.empty()) keep_workspace(path, can.name, settings);
    view.message = "How the device stands is kept in " + path.string();
  } catch (const std::exception& error) {
    view.complaint = error.what();
  }
}

void draw_calibration(ViewState& view, ConnectedDevice& device, const Vec3& handle_D_mm) {
  ViewState::Calibration& calibration = view.calibration;
  switch (calibration.step) {
    case Step::none:
      if (!ui::button("Calibrate")) return;
      calibration = {Step::right, handle_D_mm, Vec3::Zero()};
      return;
    case Step::right:
      ImGui::TextUnformatted("Move your hand to the right, then");
      if (!ui::button("That was right")) return;
      calibration = {Step::up, handle_D_mm, handle_D_mm - calibration.from_D_mm};
      return;
    case Step::up:
      ImGui::TextUnformatted("Move it up, then");
      if (!ui::button("That was up")) return;
      keep_turn(view, device, handle_D_mm - calibration.from_D_mm);
      calibration = {};
      return;
  }
}

}  // namespace

void draw_device(ViewState& view, ConnectedDevice& device) {
  ImGui::Separator();
  const DeviceReport report = device.report();
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(device.capabilities().name.c_str());
  if (const std::string complaint = report.complaint(); !complaint.empty())
    ImGui::TextColored(ui::kWarning, "It %s", complaint.c_str());
  ImGui::PopTextWrapPos();
  ImGui::TextDisabled("%.0f poses/s", report.inputs_per_s);
  ImGui::SameLine();
  draw_calibration(view, device, report.handle_D_mm);
  ui::hint("Two moves of the hand tell how the device stands; the tool stays meanwhile");
}

}  // namespace osteomill::app
