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
#include "app/simulate/view_aids_panel.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr float kWidth_px = 300;

// Returns a field's description without the option names of the command line.
std::string hint_of(const FieldDescription& field) {
  std::string text = field.doc;
  if (const auto from = text.find(" (--"); from != std::string::npos)
    text.erase(from, text.find(')', from) + 1 - from);
  for (auto at = text.find("--"); at != std::string::npos; at = text.find("--")) text.erase(at, 2);
  return text;
}

// Draws a slider for a value that takes long to apply; returns true when it is released at another value.
bool slider_on_release(const char* label, const std::string& hint, double& value, float min, float max,
                       const char* format) {
  float shown = static_cast<float>(value);
  if (ui::slider(label, hint + ". Drag, or Ctrl+click to type a number", &shown, min, max, format,
                 ImGuiSliderFlags_AlwaysClamp)) {
    value = static_cast<double>(shown);
  }
  return ImGui::IsItemDeactivatedAfterEdit();
}

// Draws a slider for a field of the requested setup, from `min` to `max`, the range of usual tools; the
// command line accepts the field's whole range.
bool field_slider(std::string_view option, MillingSetup& requested_setup, float min, float max,
                  int decimals) {
  const Field<MillingSetup>& field = *field_of_option(fields_of<MillingSetup>(), option);
  std::string label = field.option;
  std::ranges::replace(label, '-', ' ');
  double value = field.get(requested_setup);
  const bool settled = slider_on_release(label.c_str(), hint_of(field), value, min, max,
                                         fmt::format("%.{}f {}", decimals, field.unit).c_str());
  field.set(requested_setup, value);
  return settled;
}

// Draws radio buttons for a field with named values, two per row.
bool choose_field(std::string_view option, MillingSetup& requested_setup) {
  const Field<MillingSetup>& field = *field_of_option(fields_of<MillingSetup>(), option);
  bool changed = false;
  for (std::size_t n = 0; n < field.choices.size(); ++n) {
    if (n % 2 == 1) ImGui::SameLine(ui::px(kWidth_px / 2));
    if (ui::radio(field.choices[n].c_str(), fmt::format("{}: {}", field.choices[n], hint_of(field)),
                  static_cast<std::size_t>(field.get(requested_setup)) == n)) {
      field.set(requested_setup, static_cast<double>(n));
      changed = true;
    }
  }
  return changed;
}

// Returns the end of a name, which usually distinguishes scans, if the whole name does not fit.
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

// Draws the menu bar: settings not related to the bone, always visible, also if the panels are not legible.
void draw_menu(ViewState& view) {
  if (!ImGui::BeginMenuBar()) return;
  if (ui::begin_menu("Window", "Text size, colours and full screen")) {
    if (ui::button("Larger text", "Enlarges all text and buttons")) ++view.text_steps;
    if (ui::button("Smaller text", "Reduces all text and buttons")) --view.text_steps;
    if (ui::radio("Dark", "Light text on dark panels, for a dark room", view.theme == Theme::dark))
      view.theme = Theme::dark;
    if (ui::radio("Light", "Dark text on light panels, for a bright room", view.theme == Theme::light))
      view.theme = Theme::light;
    if (ui::button("Full screen (F11)##full", "Switches between full screen and a window"))
      view.full_screen_requested = true;
    if (ui::button("Start page", kStartPageHint)) view.start_page_requested = true;
    ImGui::EndMenu();
  }
  if (ui::button("Help (F1)##help", "Shows how to control tool, view and bone by mouse, keyboard or device"))
    view.help = true;
  ImGui::EndMenuBar();
}

void draw_scan(ViewState& view, const Simulation& simulation) {
  ImGui::TextUnformatted(fitting_suffix(simulation.scan.name).c_str());
  ui::tooltip(simulation.scan.name);
  view.open_requested = draw_open_buttons();
  for (const std::string& warning : simulation.warnings) ui::warning(warning);
}

void draw_algorithm(ViewState& view, bool& changed) {
  if (!ui::header("Algorithm", "Algorithm that computes the force on your hand", view.open.algorithm)) return;
  MillingSetup& requested_setup = view.requested_setup;
  bool left = true;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    if (!std::exchange(left, !left)) ImGui::SameLine(ui::px(kWidth_px / 2));
    const bool is_own = algorithm.id == default_algorithm().id;
    const std::string hint = fmt::format("Computes the force on your hand with {}, {}", algorithm.id.name,
                                         is_own ? "designed for milling; keeps the burr out of the bone"
                                                : "one of the three published algorithms, for comparison");
    if (ui::radio(algorithm.id.label.c_str(), hint, requested_setup.algorithm.id == algorithm.id)) {
      requested_setup.algorithm = algorithm;
      requested_setup.haptics.clear_option(kStiffnessOption);
      changed = true;
    }
  }
  const auto before = stiffness_of(requested_setup);
  if (!before) return;
  double stiffness = *before;
  const bool settled = slider_on_release("stiffness", "Force of the bone per millimetre that you press in",
                                         stiffness, 0.5f, 30.0f, "%.1f N/mm");
  if (stiffness != *before) requested_setup.haptics.set_option(kStiffnessOption, stiffness);
  changed = changed || settled;
}

bool is_dental(Handpiece handpiece) {
  return handpiece == Handpiece::turbine || handpiece == Handpiece::electric;
}

// Draws the list of named burrs, one column per kind.
bool choose_named_burr(MillingSetup& requested_setup, bool is_free) {
  const NamedBurr* chosen = find_burr(requested_setup.tool, requested_setup.burr);
  const NamedBurr* now = chosen;
  if (ui::button("Choose burr",
                 is_free ? "Lists surgical and dental burrs by kind and diameter"
                         : "The burrs of the exercise are in the panel at the bottom",
                 is_free))
    ImGui::OpenPopup("##burrs");
  ImGui::SameLine();
  const double wide_mm = 2 * requested_setup.tool.burr_radius_mm;
  ImGui::TextUnformatted(chosen != nullptr ? chosen->label : fmt::format("{:.1f} mm", wide_mm).c_str());
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
    const std::string hint =
        fmt::format("Burr {:g} mm and shaft {:g} mm in diameter, {}", 2 * burr.tool.burr_radius_mm,
                    2 * burr.tool.shaft_radius_mm, burr.kind);
    if (ui::entry(burr.label, hint, &burr == chosen)) chosen = &burr;
  }
  ImGui::EndGroup();
  ImGui::EndPopup();
  if (chosen == now) return false;
  requested_setup.tool = chosen->tool;
  requested_setup.burr = chosen->edge;
  return true;
}

bool switch_field(const char* label, const char* option, MillingSetup& requested_setup) {
  const Field<MillingSetup>& field = *field_of_option(fields_of<MillingSetup>(), option);
  bool on = field.get(requested_setup) != 0;
  const bool changed = ui::checkbox(label, hint_of(field), &on);
  if (changed) field.set(requested_setup, on ? 1 : 0);
  return changed;
}

// State of the choice of burr and drive. An exercise that names its burrs offers them itself.
struct ToolChoice {
  bool is_free;
  bool changed = false;
};

void draw_tool(ViewState& view, ToolChoice& choice, bool& changed) {
  if (!ui::header("Tool", "Size and speed of the burr, and the effects of its rotation on your hand",
                  view.open.tool))
    return;
  MillingSetup& setup = view.requested_setup;
  ImGui::BeginDisabled(!choice.is_free);
  choice.changed = field_slider("burr-radius", setup, 0.5f, 4.0f, 1) || choice.changed;
  choice.changed = field_slider("shaft-radius", setup, 0.3f, 3.0f, 1) || choice.changed;
  ImGui::EndDisabled();
  const float max_rpm = is_dental(setup.handpiece) ? 400000.0f : 120000.0f;
  choice.changed = field_slider("spindle-speed", setup, 5000, max_rpm, 0) || choice.changed;
  changed = switch_field("vibration", "vibration", setup) || changed;
  ImGui::SameLine();
  changed = switch_field("burr pulls", "cutting-reaction", setup) || changed;
  ImGui::SameLine();
  changed = switch_field("drag", "drag", setup) || changed;
  changed = switch_field("knock", "contact-transient", setup) || changed;
}

void draw_drive(ViewState& view, ToolChoice& choice, bool& changed) {
  if (!ui::header("Burr and drive", "Handpiece, cutting law, kind and wear of the burr", view.open.drive))
    return;
  MillingSetup& setup = view.requested_setup;
  choice.changed = choose_field("handpiece", setup) || choice.changed;
  ImGui::Separator();
  changed = choose_field("law", setup) || changed;
  ImGui::Separator();
  ImGui::BeginDisabled(setup.law != CuttingLaw::chips);
  choice.changed = choose_field("burr", setup) || choice.changed;
  changed = field_slider("wear", setup, 0, 100, 0) || changed;
  ImGui::EndDisabled();
}

void draw_undo(ViewState& view, const LiveMilling& milling) {
  const bool free = !milling.is_preparing();
  const auto cuts = static_cast<int>(milling.follower().cuts());
  if (ui::button(
          "Undo cut",
          "Restores the bone milled since the spindle was last switched on, or the last removed pieces "
          "(Ctrl+Z). Up to 256 MB of cuts are kept",
          free && cuts > 0))
    view.undo_requested = true;
  ui::same_line_if_room("Redo");
  if (ui::button("Redo", "Repeats the last undone cut, unless something else was cut since (Ctrl+Y)",
                 free && milling.follower().undone_cuts() > 0))
    view.redo_requested = true;
  ui::same_line_if_room("Reset bone");
  if (ui::button("Reset bone", "Restores the whole bone, including removed pieces",
                 free && milling.follower().is_touched()))
    view.reset_requested = true;
  const std::string text = fmt::format("{} {}", cuts, cuts == 1 ? "cut" : "cuts");
  ui::same_line_if_room(text);
  ImGui::TextDisabled("%s", text.c_str());
}

void draw_milling(ViewState& view, Simulation& simulation, ToolChoice& choice) {
  if (!ui::header("Milling", "Take the tool, choose its burr, mill, and undo cuts", view.open.milling))
    return;
  LiveMilling& milling = simulation.milling;
  if (simulation.tool_source.is_pointer()) {
    if (ui::button(view.holding_tool ? "Let go (T)##hold" : "Take the tool (T)##hold",
                   "Takes the tool, so that it follows the mouse, or lets it go"))
      view.holding_tool = !view.holding_tool;
    ImGui::SameLine();
  }
  if (ui::button(
          "Bring it here (B)##bring",
          "Moves the tool in front of the bone at the centre of the view; the key B uses the bone under "
          "the pointer"))
    view.bring_requested = true;
  // A device's own button can also switch the spindle on.
  bool spindle = milling.is_spindle_requested() || milling.state().spindle_on;
  if (ui::checkbox("spindle on", "Turns the burr on or off (Space)", &spindle)) milling.set_spindle(spindle);
  ImGui::SameLine();
  ui::checkbox("sound", "Plays the sound of the spindle and of cutting", &view.sound);
  ImGui::SameLine();
  bool paused = milling.state().record.paused;
  if (ui::checkbox("pause", "Pauses milling, without a force on your hand (P)", &paused))
    milling.set_paused(paused);
  choice.changed = choose_named_burr(view.requested_setup, choice.is_free) || choice.changed;
  draw_undo(view, milling);
  draw_piece_controls(view, simulation);
}

// Draws buttons for the candidate isovalues, if there are several: only the user knows which boundary is
// bone. They are next to the histogram, or below it if they do not fit.
void draw_boundaries(ViewState& view, Simulation& simulation) {
  if (simulation.scan.boundaries.size() < 2) return;
  const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const ImGuiStyle& style = ImGui::GetStyle();
  for (const Boundary& boundary : simulation.scan.boundaries) {
    const std::string label = fmt::format("{:.4g}", boundary.density);
    const float width = ImGui::CalcTextSize(label.c_str()).x + 2 * style.FramePadding.x;
    if (ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= right) ImGui::SameLine();
    const std::string hint = fmt::format(
        "Sets the isovalue to {:.4g}, the boundary in this scan between materials of {:.4g} and {:.4g}",
        boundary.density, boundary.below, boundary.above);
    if (ui::button(label.c_str(), hint, !simulation.milling.is_preparing()))
      view.isovalue_requested = boundary.density;
  }
}

void draw_isovalue(ViewState& view, Simulation& simulation) {
  if (!ui::header("Bone", "Density above which the scan counts as bone", view.open.bone)) return;
  const DensityHistogram& histogram = simulation.scan.histogram;
  LiveMilling& milling = simulation.milling;
  float isovalue = view.isovalue.value_or(static_cast<float>(milling.isovalue()));
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::CalcItemWidth(), 1.5f * ImGui::GetFontSize());
  // Disabled, so that ImGui does not show its own tooltip.
  ImGui::BeginDisabled();
  ImGui::PlotHistogram("##densities", histogram.log_counts.data(),
                       static_cast<int>(histogram.log_counts.size()), 0, nullptr, 0, FLT_MAX, size);
  ImGui::EndDisabled();
  ui::tooltip("Number of voxels of each density, from lowest to highest; the line marks the isovalue");
  const float share = (isovalue - histogram.min) / (histogram.max - histogram.min);
  const float x = place.x + std::clamp(share, 0.0f, 1.0f) * size.x;
  ImGui::GetWindowDrawList()->AddLine({x, place.y}, {x, place.y + size.y}, IM_COL32(255, 180, 60, 255), 2);
  draw_boundaries(view, simulation);
  ImGui::BeginDisabled(milling.is_preparing());
  const std::string format = "%.4g" + simulation.scan.unit;
  if (ui::slider("isovalue", "Higher densities are bone. Drag, or Ctrl+click to type a number", &isovalue,
                 histogram.min, histogram.max, format.c_str(), ImGuiSliderFlags_AlwaysClamp)) {
    view.isovalue = isovalue;
    milling.show_isovalue(static_cast<double>(isovalue));
  }
  const bool moved = ImGui::IsItemActive();
  if (ImGui::IsItemDeactivatedAfterEdit() && view.isovalue)
    view.isovalue_requested = static_cast<double>(*view.isovalue);
  ImGui::EndDisabled();
  if (!moved && !milling.is_preparing() && !view.isovalue_requested) view.isovalue.reset();
  ImGui::TextWrapped("%s", isovalue_text(simulation).c_str());
}

void draw_cuts(ViewState& view, Simulation& simulation) {
  if (!ui::header("Cuts", "Planes that cut the bone open and show the scan's grey values", view.open.cuts))
    return;
  for (std::size_t n = 0; n < view.cuts.size(); ++n) {
    ViewState::SectionPlane& cut = view.cuts[n];
    ImGui::PushID(static_cast<int>(n));
    const std::string hint =
        fmt::format("Cuts the bone open at the burr, along {}",
                    n == 3 ? "the plane of the screen" : fmt::format("the {} plane", kCutNames[n]));
    if (ui::checkbox(kCutNames[n], hint, &cut.on) && cut.on) {
      if (n == 3) cut.normal_W = -view.camera.towards_viewer_W();
      begin_cut_at(view, cut, simulation.milling.state().record.X_WT.position_mm);
    }
    if (cut.on) {
      ImGui::SameLine(ui::px(100));
      ui::checkbox("other side", "Shows the half of the bone that is hidden by this cut", &cut.other_side);
      const GridGeometry& grid = simulation.milling.geometry();
      const auto extent = extent_along(corners_W(grid, grid.all_voxels()), cut.normal_W);
      ui::slider((std::string(kCutNames[n]) + " place").c_str(),
                 "Moves the cut through the bone (or drag it with Ctrl and the left button)", &cut.offset_mm,
                 static_cast<float>(extent[0]), static_cast<float>(extent[1]), "%.1f mm");
    }
    ImGui::PopID();
  }
  draw_grey(view, simulation.scan.grey_window);
}

void draw_view(ViewState& view, const Vec3& tool_W, const PixelSize& size) {
  if (!ui::header("View", "Viewing direction, and what is drawn besides the bone", view.open.view)) return;
  for (const auto& [from, direction_W, up_W] : kPatientViews) {
    const std::string letter(1, static_cast<char>(std::toupper(from.front())));
    if (ui::button((letter + "##view").c_str(), fmt::format("Shows the whole bone from {}", from)))
      view.camera = fit_bone(camera_on(view.box.bounds(), direction_W, up_W), view.box, size);
    ImGui::SameLine();
  }
  if (ui::button("Whole", kWholeHint)) view.camera = fit_bone(view.camera, view.box, size);
  if (ui::button("Find tool", "Centres the view on the burr")) view.camera.focus_W = tool_W;
  ImGui::SameLine();
  ui::checkbox("ghost", kGhostHint, &view.ghost);
  ImGui::SameLine();
  ui::checkbox("arrows", kArrowsHint, &view.arrows);
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
  return fmt::format("set here; initially {:.4g}{}, {}", simulation.scan.isovalue, simulation.scan.unit,
                     simulation.scan.isovalue_from);
}

void request_remembered_tool(ViewState& view) {
  MillingSetup setup = view.requested_setup;
  if (!copy_tool(view.tool, setup) || !tool_fault(setup.tool, view.box).empty()) return;
  view.requested_setup = setup;
  view.setup_changed = true;
}

// Draws the controls for researchers.
static void draw_laboratory(ViewState& view, ToolChoice& choice, bool& changed) {
  if (!ui::header("Laboratory", "Algorithm, tool size, speed, drive, cutting law, and all readings",
                  view.open.laboratory))
    return;
  ImGui::Indent(ui::px(8));
  draw_algorithm(view, changed);
  draw_tool(view, choice, changed);
  draw_drive(view, choice, changed);
  ImGui::Unindent(ui::px(8));
}

void draw_controls(ViewState& view, Simulation& simulation, FilesPanel& files, const PixelSize& size) {
  ImGui::SetNextWindowPos({ui::px(8), ui::px(8)});
  const float width = ui::px(kWidth_px);
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, static_cast<float>(size.height) - ui::px(70)});
  ui::begin_panel("osteomill", view.open.controls,
                  ImGuiWindowFlags_MenuBar | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(ui::px(130));
  draw_menu(view);
  draw_scan(view, simulation);
  bool changed = false;
  ToolChoice choice{!simulation.exercise || simulation.exercise->placed().exercise.burrs.empty()};
  draw_milling(view, simulation, choice);
  draw_view(view, simulation.milling.state().record.X_WT.position_mm, size);
  files.draw(view, simulation);
  draw_view_aid_controls(view, files);
  draw_cuts(view, simulation);
  draw_isovalue(view, simulation);
  draw_laboratory(view, choice, changed);
  if (choice.changed && choice.is_free && !simulation.from) copy_tool(view.requested_setup, view.tool);
  changed = changed || choice.changed;
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
