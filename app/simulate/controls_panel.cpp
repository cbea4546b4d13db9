#include <algorithm>
#include <cctype>
#include <cfloat>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/milling/named_burrs.h"

#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr float kWidth_px = 300;

// A slider for what takes long to change: true once it is let go of at another value.
bool settle(const char* label, double& value, float min, float max, const char* format) {
  float shown = static_cast<float>(value);
  if (ui::slider(label, &shown, min, max, format, ImGuiSliderFlags_AlwaysClamp)) {
    value = static_cast<double>(shown);
  }
  return ImGui::IsItemDeactivatedAfterEdit();
}

// A slider for a field of what is wanted: its values from `min` to `max`, which are those of usual tools. The
// command line takes the field's whole range.
bool settle_field(std::string_view option, MillingSetup& requested_setup, float min, float max,
                  int decimals) {
  const Field<MillingSetup>& field = *field_of_option(fields_of<MillingSetup>(), option);
  std::string label = field.option;
  std::ranges::replace(label, '-', ' ');
  double value = field.get(requested_setup);
  const bool settled =
      settle(label.c_str(), value, min, max, fmt::format("%.{}f {}", decimals, field.unit).c_str());
  ui::tooltip(field.doc);
  field.set(requested_setup, value);
  return settled;
}

// Radio buttons for a field of names, two in a row.
bool choose_field(std::string_view option, MillingSetup& requested_setup) {
  const Field<MillingSetup>& field = *field_of_option(fields_of<MillingSetup>(), option);
  bool changed = false;
  for (std::size_t n = 0; n < field.choices.size(); ++n) {
    if (n % 2 == 1) ImGui::SameLine(ui::px(kWidth_px / 2));
    if (ui::radio(field.choices[n].c_str(), static_cast<std::size_t>(field.get(requested_setup)) == n)) {
      field.set(requested_setup, static_cast<double>(n));
      changed = true;
    }
    ui::tooltip(field.doc);
  }
  return changed;
}

// The end of a name, which tells one scan from another, if there is no room for all of it.
std::string fitting_suffix(const std::string& name) {
  const float room = ImGui::GetContentRegionAvail().x;
  std::string shown = name;
  std::size_t first = 0;
  while (ImGui::CalcTextSize(shown.c_str()).x > room && first < name.size()) {
    do ++first;
    while (first < name.size() && (static_cast<unsigned char>(name[first]) & 0xC0) == 0x80);
    shown = "..." + name.substr(first);
  }
  return shown;
}

void draw_scan(ViewState& view, const std::string& name) {
  ImGui::TextUnformatted(fitting_suffix(name).c_str());
  ui::tooltip(name);
  const bool entered = ui::text_field("scan", view.scan_path.data(), view.scan_path.size());
  ui::tooltip("Path of a DICOM folder or of a NRRD, MetaImage or NIfTI file; or drop it onto the window");
  ImGui::SameLine();
  const bool pressed = ui::button("Open");
  if ((entered || pressed) && view.scan_path[0] != 0) view.scan_requested = view.scan_path.data();
}

void draw_algorithm(MillingSetup& requested_setup, bool& changed) {
  if (!ui::header("Algorithm", true)) return;
  bool left = true;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    if (!std::exchange(left, !left)) ImGui::SameLine(ui::px(kWidth_px / 2));
    if (ui::radio(algorithm.id.label.c_str(), requested_setup.algorithm.id == algorithm.id)) {
      requested_setup.algorithm = algorithm;
      requested_setup.haptics.clear_option(kStiffnessOption);
      changed = true;
    }
  }
  const auto before = stiffness_of(requested_setup);
  if (!before) return;
  double stiffness = *before;
  const bool settled = settle("stiffness", stiffness, 0.5f, 30.0f, "%.1f N/mm");
  if (stiffness != *before) requested_setup.haptics.set_option(kStiffnessOption, stiffness);
  changed = changed || settled;
}

bool is_dental(Handpiece handpiece) {
  return handpiece == Handpiece::turbine || handpiece == Handpiece::electric;
}

// Draws the list of burrs with a name, a column for each kind.
bool choose_named_burr(MillingSetup& requested_setup) {
  const NamedBurr* chosen = find_burr(requested_setup.tool, requested_setup.burr);
  const NamedBurr* now = chosen;
  if (ui::button("Burr by name")) ImGui::OpenPopup("##burrs");
  ImGui::SameLine();
  ImGui::TextUnformatted(chosen != nullptr ? chosen->label : "own sizes");
  if (!ImGui::BeginPopup("##burrs")) return false;
  std::string_view kind;
  for (const NamedBurr& burr : named_burrs()) {
    if (burr.kind != kind) {
      if (!kind.empty()) {
        ImGui::EndGroup();
        ImGui::SameLine();
      }
      kind = burr.kind;
      ImGui::BeginGroup();
      ImGui::TextDisabled("%s", burr.kind);
    }
    if (ui::entry(burr.label, &burr == chosen)) chosen = &burr;
  }
  ImGui::EndGroup();
  ImGui::EndPopup();
  if (chosen == now) return false;
  requested_setup.tool = chosen->tool;
  requested_setup.burr = chosen->edge;
  return true;
}

// An exercise that names its burrs offers them itself.
void draw_tool(MillingSetup& requested_setup, bool has_choice, bool& sound, bool& changed) {
  if (!ui::header("Tool", true)) return;
  ImGui::BeginDisabled(!has_choice);
  changed = settle_field("burr-radius", requested_setup, 0.5f, 4.0f, 1) || changed;
  changed = settle_field("shaft-radius", requested_setup, 0.3f, 3.0f, 1) || changed;
  ImGui::EndDisabled();
  const float max_rpm = is_dental(requested_setup.handpiece) ? 400000.0f : 120000.0f;
  changed = settle_field("spindle-speed", requested_setup, 5000, max_rpm, 0) || changed;
  changed = ui::checkbox("vibration", &requested_setup.vibration.on) || changed;
  ui::tooltip("You feel the burr's teeth in the hand");
  ImGui::SameLine();
  changed = ui::checkbox("burr pulls", &requested_setup.cutting_reaction) || changed;
  ui::tooltip("Cutting pulls the burr sideways, as it turns, and twists the handle");
  ImGui::SameLine();
  ui::checkbox("sound", &sound);
}

void draw_drive(MillingSetup& requested_setup, bool has_choice, bool& changed) {
  if (!ui::header("Burr and drive", false)) return;
  ImGui::BeginDisabled(!has_choice);
  changed = choose_named_burr(requested_setup) || changed;
  ImGui::EndDisabled();
  ImGui::Separator();
  changed = choose_field("handpiece", requested_setup) || changed;
  ImGui::Separator();
  changed = choose_field("law", requested_setup) || changed;
  ImGui::Separator();
  ImGui::BeginDisabled(requested_setup.law != CuttingLaw::chips);
  changed = choose_field("burr", requested_setup) || changed;
  changed = settle_field("wear", requested_setup, 0, 100, 0) || changed;
  ImGui::EndDisabled();
  changed = ui::checkbox("drag", &requested_setup.drag) || changed;
  ui::tooltip(field_of_option(fields_of<MillingSetup>(), "drag")->doc);
  ImGui::SameLine();
  changed = ui::checkbox("knock", &requested_setup.contact_transient.on) || changed;
  ui::tooltip(field_of_option(fields_of<MillingSetup>(), "contact-transient")->doc);
}

void draw_session(ViewState& view, LiveMilling& milling, bool by_pointer) {
  if (!ui::header("Milling", true)) return;
  // A device's own button turns it on as well.
  bool spindle = milling.is_spindle_requested() || milling.state().spindle_on;
  if (ui::checkbox("spindle on", &spindle)) milling.set_spindle(spindle);
  ImGui::SameLine();
  bool paused = milling.state().record.paused;
  if (ui::checkbox("pause", &paused)) milling.set_paused(paused);
  if (by_pointer) {
    ImGui::SameLine();
    if (ui::button(view.holding_tool ? "Let go (T)##hold" : "Take the tool (T)##hold")) {
      view.holding_tool = !view.holding_tool;
    }
  }
  const bool free = !milling.is_preparing();
  if (ui::button("Undo cut", free && milling.follower().cuts() > 0)) view.undo_requested = true;
  ui::tooltip(
      "Puts back what was milled since the spindle was last switched on (up to 256 MB of cuts are kept)");
  ImGui::SameLine();
  if (ui::button("Reset bone", free && milling.follower().is_touched())) view.reset_requested = true;
  ImGui::SameLine();
  const auto cuts = static_cast<int>(milling.follower().cuts());
  ImGui::TextDisabled(cuts == 1 ? "%d cut" : "%d cuts", cuts);
}

// Buttons for the densities that may bound bone, if there are several: only the user knows which does.
// They stand beside the histogram, and below it if there is no room.
void draw_boundaries(ViewState& view, Simulation& simulation) {
  if (simulation.scan.boundaries.size() < 2) return;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const ImGuiStyle& style = ImGui::GetStyle();
  for (const Boundary& boundary : simulation.scan.boundaries) {
    const std::string label = fmt::format("{:.4g}", boundary.density);
    const float width = ImGui::CalcTextSize(label.c_str()).x + 2 * style.FramePadding.x;
    if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= right) ImGui::SameLine();
    if (ui::button(label.c_str(), !simulation.milling.is_preparing()))
      view.isovalue_requested = boundary.density;
    ui::tooltip(
        fmt::format("A boundary of the scan: {:.4g} below, {:.4g} above", boundary.below, boundary.above));
  }
}

void draw_isovalue(ViewState& view, Simulation& simulation) {
  if (!ui::header("Bone", true)) return;
  const DensityHistogram& histogram = simulation.scan.histogram;
  LiveMilling& milling = simulation.milling;
  float isovalue = view.isovalue.value_or(static_cast<float>(milling.isovalue()));
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::CalcItemWidth(), 1.5f * ImGui::GetFontSize());
  ImGui::PlotHistogram("##densities", histogram.log_counts.data(),
                       static_cast<int>(histogram.log_counts.size()), 0, nullptr, 0, FLT_MAX, size);
  const float share = (isovalue - histogram.min) / (histogram.max - histogram.min);
  const float x = place.x + std::clamp(share, 0.0f, 1.0f) * size.x;
  ImGui::GetWindowDrawList()->AddLine({x, place.y}, {x, place.y + size.y}, IM_COL32(255, 180, 60, 255), 2);
  draw_boundaries(view, simulation);
  ImGui::BeginDisabled(milling.is_preparing());
  const std::string format = "%.4g" + simulation.scan.unit;
  if (ui::slider("isovalue", &isovalue, histogram.min, histogram.max, format.c_str(),
                 ImGuiSliderFlags_AlwaysClamp)) {
    view.isovalue = isovalue;
    milling.show_isovalue(static_cast<double>(isovalue));
  }
  const bool moved = ImGui::IsItemActive();
  if (ImGui::IsItemDeactivatedAfterEdit() && view.isovalue)
    view.isovalue_requested = static_cast<double>(*view.isovalue);
  ui::tooltip("What is denser than this is bone. Drag, or hold Ctrl and click to type a number");
  ImGui::EndDisabled();
  if (!moved && !milling.is_preparing() && !view.isovalue_requested) view.isovalue.reset();
  ImGui::TextWrapped("%s", isovalue_text(simulation).c_str());
  for (const std::string& warning : simulation.warnings) ui::warning(warning);
}

void draw_cuts(ViewState& view, Simulation& simulation) {
  if (!ui::header("Cuts", false)) return;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    ViewState::Cut& cut = view.cuts[n];
    ImGui::PushID(static_cast<int>(n));
    if (ui::checkbox(kCutNames[n], &cut.on) && cut.on) {
      if (n == 3) cut.normal_W = -view.camera.towards_viewer_W();
      begin_cut_at(view, cut, simulation.milling.state().record.X_WT.position_mm);
    }
    if (cut.on) {
      ImGui::SameLine(ui::px(100));
      ui::checkbox("other side", &cut.other_side);
      const GridGeometry& grid = simulation.milling.geometry();
      const auto extent = extent_along(corners_W(grid, grid.all_voxels()), cut.normal_W);
      ui::slider((std::string(kCutNames[n]) + " place").c_str(), &cut.offset_mm,
                 static_cast<float>(extent[0]), static_cast<float>(extent[1]), "%.1f mm");
    }
    ImGui::PopID();
  }
}

void draw_view(ViewState& view, const Vec3& tool_W, const PixelSize& size) {
  if (!ui::header("View", true)) return;
  for (const auto& [from, direction_W, up_W] : kPatientViews) {
    const std::string letter(1, static_cast<char>(std::toupper(from.front())));
    if (ui::button((letter + "##view").c_str()))
      view.camera = showing_whole(camera_on(view.box.bounds(), direction_W, up_W), view.box, size);
    ui::tooltip(fmt::format("From {}", from));
    ImGui::SameLine();
  }
  if (ui::button("Whole")) view.camera = showing_whole(view.camera, view.box, size);
  ui::tooltip("Shows all of the bone from the same side");
  if (ui::button("Find tool")) view.camera.focus_W = tool_W;
  ui::tooltip("Moves the view so that the burr is in its middle");
  ImGui::SameLine();
  if (ui::button("Bring it here (B)##bring")) view.bring_requested = true;
  ui::tooltip(
      "Brings the tool to just before the bone in the middle of the view; the key B, to just before the "
      "bone under the pointer");
  ui::checkbox("ghost", &view.ghost);
  ImGui::SameLine();
  ui::checkbox("arrows", &view.arrows);
}

// They come first, for users who cannot read the rest or cannot reach the buttons below.
void draw_reading_aids(ViewState& view) {
  if (ui::button("Help")) view.help = true;
  ImGui::SameLine();
  if (ui::button("Smaller text")) --view.text_steps;
  ImGui::SameLine();
  if (ui::button("Larger text")) ++view.text_steps;
}

}  // namespace

std::optional<double> stiffness_of(const MillingSetup& setup) {
  const SettingDescription* stiffness = setting_of_option(setup.algorithm, kStiffnessOption);
  if (stiffness == nullptr) return std::nullopt;
  const std::vector<SettingDescription> values = setting_values(setup.algorithm, setup.haptics);
  return std::find_if(values.begin(), values.end(),
                      [&](const auto& one) { return one.name == stiffness->name; })
      ->value;
}

std::string isovalue_text(const Simulation& simulation) {
  if (simulation.milling.isovalue() == simulation.scan.isovalue) return simulation.scan.isovalue_from;
  return fmt::format("set here; first {:.4g}{}, {}", simulation.scan.isovalue, simulation.scan.unit,
                     simulation.scan.isovalue_from);
}

void draw_controls(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size) {
  ImGui::SetNextWindowPos({ui::px(8), ui::px(8)});
  const float width = ui::px(kWidth_px);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, static_cast<float>(size.height) - ui::px(70)});
  ImGui::Begin("osteomill", nullptr, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(ui::px(130));
  draw_reading_aids(view);
  draw_scan(view, simulation.scan.name);
  bool changed = false;
  draw_isovalue(view, simulation);
  draw_session(view, simulation.milling, simulation.tool_source.is_pointer());
  draw_algorithm(view.requested_setup, changed);
  const bool has_choice = !simulation.exercise || simulation.exercise->placed().exercise.burrs.empty();
  draw_tool(view.requested_setup, has_choice, view.sound, changed);
  draw_drive(view.requested_setup, has_choice, changed);
  draw_view(view, simulation.milling.state().record.X_WT.position_mm, size);
  draw_cuts(view, simulation);
  files.draw(view, simulation);
  view.setup_changed = view.setup_changed || changed;
  view.changes += changed ? 1 : 0;
  if (view.setup_changed && !simulation.milling.is_preparing()) {
    view.setup_changed = false;
    if (const std::string fault = tool_fault(view.requested_setup.tool, view.box); !fault.empty()) {
      view.dialogues.add_error(fault);
      view.requested_setup = simulation.milling.setup();
    } else {
      view.dialogues.run_reporting_errors(
          [&] { view.setup_changed = !simulation.milling.change(view.requested_setup); });
    }
  }
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace osteomill::app
