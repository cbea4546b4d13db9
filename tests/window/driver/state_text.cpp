#include "tests/window/driver/state_text.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <imgui_internal.h>

#include "app/simulate/exercise_panel.h"
#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

std::string text_of(const Vec3& v) {
  return fmt::format("{:.3f} {:.3f} {:.3f}", v.x(), v.y(), v.z());
}

// Transforms a vector into the viewer's axes: right, up, towards the viewer.
Vec3 seen(const Camera& camera, const Vec3& v_W) {
  return camera.orientation.conjugate() * v_W;
}

class Lines {
 public:
  explicit Lines(std::string name) : name_(std::move(name)) {}
  template <typename Value>
  void add(std::string_view key, const Value& value) {
    text_ += fmt::format("{}.{}={}\n", name_, key, value);
  }
  const std::string& text() const { return text_; }

 private:
  std::string name_;
  std::string text_;
};

// Adds all controls that can be clicked now, with their positions.
void add_controls(Lines& lines) {
  std::string labels;
  for (const auto& [label, state] : ui::widget_states()) {
    if (state.frame < ImGui::GetFrameCount() - 1) continue;
    labels += "[" + label + "]";
    const Eigen::Vector2d middle(static_cast<double>(state.middle.x), static_cast<double>(state.middle.y));
    lines.add("place of " + label, fmt::format("{:.0f} {:.0f}", middle.x(), middle.y()));
  }
  lines.add("shown", labels);
}

// Returns the drawn windows that have none of these flags.
std::vector<const ImGuiWindow*> windows_without(ImGuiWindowFlags flags) {
  std::vector<const ImGuiWindow*> found;
  for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
    if (window->Active && !window->Hidden && !window->IsFallbackWindow && (window->Flags & flags) == 0)
      found.push_back(window);
  }
  return found;
}

// Adds layout faults: controls without a hint or cut off, panels outside the window, and overlapping panels.
void add_faults(Lines& lines) {
  std::string unexplained, cut_off, outside, covered;
  for (const auto& [label, state] : ui::widget_states()) {
    if (state.frame < ImGui::GetFrameCount() - 1) continue;
    const bool is_sentence = state.hint.size() > label.size() && state.hint.find(' ') != std::string::npos;
    if (!is_sentence) unexplained += "[" + label + "]";
    if (state.is_cut_off) cut_off += "[" + label + "]";
  }
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  for (const ImGuiWindow* window : windows_without(0)) {
    const float room_px = window->InnerRect.GetWidth() - 2 * window->WindowPadding.x;
    if (!window->Collapsed && window->ContentSize.x > room_px + 1)
      cut_off += fmt::format("[{}: {:.0f} in {:.0f}]", window->Name, window->ContentSize.x, room_px);
  }
  // Hints, menus and dialogues may cover panels.
  const std::vector<const ImGuiWindow*> all =
      windows_without(ImGuiWindowFlags_ChildWindow | ImGuiWindowFlags_Tooltip | ImGuiWindowFlags_Popup |
                      ImGuiWindowFlags_Modal);
  for (std::size_t n = 0; n < all.size(); ++n) {
    const ImGuiWindow& one = *all[n];
    const ImRect rect = one.Rect();
    if (rect.Min.x < 0 || rect.Min.y < 0 || rect.Max.x > size.x || rect.Max.y > size.y)
      outside += fmt::format("[{}]", one.Name);
    for (std::size_t m = 0; m < n; ++m)
      if (rect.Overlaps(all[m]->Rect())) covered += fmt::format("[{}, {}]", all[m]->Name, one.Name);
  }
  lines.add("unexplained", unexplained);
  lines.add("cut_off", cut_off);
  lines.add("outside", outside);
  lines.add("covered", covered);
}

double brightness(const ImVec4& colour) {
  const auto linear = [](float value) {
    const double v = static_cast<double>(value);
    return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(colour.x) + 0.7152 * linear(colour.y) + 0.0722 * linear(colour.z);
}

ImVec4 over(const ImVec4& colour, const ImVec4& ground) {
  const auto mix = [&](float a, float b) { return colour.w * a + (1 - colour.w) * b; };
  return {mix(colour.x, ground.x), mix(colour.y, ground.y), mix(colour.z, ground.z), 1};
}

double contrast(const ImVec4& one, const ImVec4& other) {
  const double a = brightness(one), b = brightness(other);
  return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
}

// Returns the lowest contrast (WCAG 2) of text on its backgrounds, and of coloured text on panels.
double least_contrast() {
  const ImVec4* const colours = ImGui::GetStyle().Colors;
  const ImVec4 panel = over(colours[ImGuiCol_WindowBg], {0.2f, 0.2f, 0.24f, 1});
  double least = 21;
  for (const ImGuiCol ground :
       {ImGuiCol_WindowBg, ImGuiCol_PopupBg, ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_SliderGrab,
        ImGuiCol_SliderGrabActive, ImGuiCol_Button, ImGuiCol_Header, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive,
        ImGuiCol_MenuBarBg})
    least = std::min(least, contrast(colours[ImGuiCol_Text], over(colours[ground], panel)));
  for (const ui::Ink ink : {ui::Ink::warning, ui::Ink::danger, ui::Ink::good, ui::Ink::note})
    least = std::min(least, contrast(ui::ink(ink), panel));
  return least;
}

void add_setup(Lines& lines, const MillingSetup& setup) {
  lines.add("algorithm", setup.algorithm.id.name);
  if (const auto stiffness = stiffness_of(setup)) lines.add("stiffness", fmt::format("{:.2f}", *stiffness));
  lines.add("burr_mm", fmt::format("{:.2f}", setup.tool.burr_radius_mm));
  lines.add("shaft_mm", fmt::format("{:.2f}", setup.tool.shaft_radius_mm));
  lines.add("rpm", fmt::format("{:.0f}", setup.cutting.spindle_speed_rpm));
  for (const char* option : {"handpiece", "law", "burr", "wear", "drag", "contact-transient"})
    lines.add(option, field_of_option(fields_of<MillingSetup>(), option)->get(setup));
  lines.add("vibration", setup.vibration.on);
  lines.add("cutting_reaction", setup.cutting_reaction);
}

void add_scene(Lines& lines, const ViewState& view, const ViewScene& scene, const PixelSize& size) {
  lines.add("towards_viewer", text_of(scene.camera.towards_viewer_W()));
  lines.add("focus", text_of(scene.camera.focus_W));
  lines.add("distance_mm", fmt::format("{:.2f}", scene.camera.distance_mm));
  const Eigen::Vector2d tool = pixel_of(scene.camera, size, scene.X_WT->position_mm);
  int seen_whole = 0;
  for (const Vec3& corner_W : view.box.corners_W) {
    const Eigen::Vector2d corner = pixel_of(scene.camera, size, corner_W);
    seen_whole +=
        corner.x() > 300 && corner.x() < size.width - 300 && corner.y() > 0 && corner.y() < size.height ? 1
                                                                                                        : 0;
  }
  lines.add("corners_seen", seen_whole);
  lines.add("up_seen", text_of(seen(scene.camera, Vec3::UnitZ())));
  lines.add("tool_px", fmt::format("{:.0f} {:.0f}", tool.x(), tool.y()));
  lines.add("see_through", scene.see_through);
  lines.add("tool_W", text_of(scene.X_WT->position_mm));
  lines.add("tool_seen", text_of(seen(scene.camera, scene.X_WT->position_mm)));
  lines.add("ghost", scene.X_WD.has_value());
  lines.add("force_arrow_N", fmt::format("{:.3f}", scene.wrench.force_N.norm()));
  for (std::size_t n = 0; n < scene.cuts.size(); ++n) {
    lines.add(kCutNames[n], scene.cuts[n] ? fmt::format("{} at {:.2f}", text_of(scene.cuts[n]->normal_W),
                                                        scene.cuts[n]->offset_mm)
                                          : "off");
  }
}

}  // namespace

static std::string playback_text(Lines lines, const WindowContents& window) {
  const Playback& playback = *window.playback;
  add_scene(lines, window.view, scene_of(window.view, playback), window.window.size());
  lines.add("time_s", fmt::format("{:.6f}", playback.record().time_s));
  lines.add("tick", playback.tick());
  lines.add("playing", playback.is_playing());
  lines.add("speed", playback.speed());
  lines.add("recorded_camera", playback.is_following_recorded_view());
  lines.add("verdict", playback.verdict());
  lines.add("force_N", fmt::format("{:.3f}", playback.record().wrench.force_N.norm()));
  playback.follower().read([&](const Volume& bone) { lines.add("bone", bone.change_hash()); });
  lines.add("marks", fmt::format("{} {} {} {} {}", playback.marks().cuts.size(),
                                 playback.marks().contacts.size(), playback.marks().no_go.size(),
                                 playback.marks().faults.size(), playback.marks().steps.size()));
  lines.add("dialogue",
            window.view.dialogues.current() != nullptr ? window.view.dialogues.current()->text : "");
  add_controls(lines);
  add_faults(lines);
  return lines.text();
}

std::string state_text(const std::string& name, const WindowContents& window) {
  if (window.playback != nullptr && window.simulation == nullptr) return playback_text(Lines(name), window);
  const ViewState& view = window.view;
  Simulation& simulation = *window.simulation;
  const FilesPanel& files = window.files;
  const PixelSize size = window.window.size();
  Lines lines(name);
  LiveMilling& milling = simulation.milling;
  const LiveState& state = milling.state();
  add_setup(lines, milling.setup());
  add_scene(lines, view, scene_of(view, simulation), size);
  lines.add("target_seen", text_of(seen(view.camera, view.X_W_target.position_mm)));
  lines.add("target_turned", text_of(seen(view.camera, rotation_vector(view.X_W_target.orientation))));
  lines.add("shaft_seen", text_of(seen(view.camera, state.record.X_WT.orientation * Vec3::UnitZ())));
  lines.add("force_N", fmt::format("{:.3f}", state.record.wrench.force_N.norm()));
  lines.add("in_hand", view.holding_tool);
  lines.add("spindle", state.spindle_on);
  lines.add("paused", state.record.paused);
  lines.add("true_rpm", fmt::format("{:.0f}", state.record.spindle_rpm));
  lines.add("heard_rpm", fmt::format("{:.0f}", window.sound.speed_rpm));
  lines.add("isovalue", fmt::format("{:.6g}", milling.isovalue()));
  lines.add("isovalue_from", isovalue_text(simulation));
  lines.add("warnings", simulation.warnings.empty() ? "" : simulation.warnings.front());
  lines.add("removed_mm3", fmt::format("{:.3f}", state.record.removed_mm3));
  lines.add("cuts", milling.follower().cuts());
  lines.add("undone_cuts", milling.follower().undone_cuts());
  if (const auto& piece = view.chosen_piece.piece) {
    const double voxel_mm3 = milling.geometry().voxel_volume_mm3();
    lines.add("piece_mm3", fmt::format("{:.3f}", static_cast<double>(piece->voxels) * voxel_mm3));
    lines.add("pieces", piece->sizes.size());
  }
  lines.add("bone_size_mm", text_of(view.box.corners_W.back() - view.box.corners_W.front()));
  for (std::size_t n = 0; n < simulation.label_count.labels().size(); ++n) {
    const bool counted = n + 1 < simulation.removed_by_label_mm3.size();
    lines.add("removed of " + simulation.label_count.labels()[n].name,
              fmt::format("{:.3f}", counted ? simulation.removed_by_label_mm3[n + 1] : 0));
  }
  lines.add("no_go", simulation.no_go_text);
  const ConnectedDevice* hardware = simulation.tool_source.hardware;
  lines.add("device", hardware != nullptr ? hardware->capabilities().name : simulation.tool_source.name);
  lines.add("device_fault", hardware != nullptr ? hardware->report().complaint() : "");
  lines.add("unsaved", simulation.autosave.has_unsaved(milling));
  lines.add("recording", milling.is_recording());
  const auto recording_s = files.recording_s(simulation);
  lines.add("badge", recording_s ? recording_text(*recording_s) : "");
  lines.add("last_recording", files.last_recording().string());
  lines.add("scan", simulation.scan.name);
  if (const ExerciseWork* work = simulation.exercise.get()) {
    lines.add("exercise", work->placed().exercise.title);
    lines.add("step", work->step());
    lines.add("step_percent", fmt::format("{:.1f}", work->step_percent()));
    lines.add("guidance", work->has_guidance());
    lines.add("distance", distance_text(simulation, state.record));
    const double radius_mm = milling.setup().tool.burr_radius_mm;
    lines.add("beats_per_s",
              fmt::format("{:.2f}", work->beat(state.record.X_WT.position_mm, radius_mm).beats_per_s));
    lines.add("results", work->results().size());
    lines.add("debrief", work->folder().string());
  }
  lines.add("help", view.help);
  std::string landmarks;
  for (const Landmark& mark : view.landmarks) landmarks += mark.name + " " + text_of(mark.point_W) + "; ";
  lines.add("landmarks", landmarks);
  if (view.landmarks.size() > 1)
    lines.add("distance_mm_of_two", fmt::format("{:.4f}", distance_mm(view.landmarks[0], view.landmarks[1])));
  const WindowLevel grey = view.grey_window.value_or(simulation.scan.grey_window);
  lines.add("grey", fmt::format("{:.2f} {:.2f}", 0.5 * (grey.black + grey.white), grey.white - grey.black));
  lines.add("last_folder", view.last_folder);
  lines.add("message", view.message);
  lines.add("dialogue", view.dialogues.current() != nullptr ? view.dialogues.current()->text : "");
  add_controls(lines);
  add_faults(lines);
  lines.add("contrast", fmt::format("{:.2f}", least_contrast()));
  lines.add("ui_scale", fmt::format("{:.2f}", static_cast<double>(ui::px(1))));
  lines.add("size", fmt::format("{} x {}", size.width, size.height));
  return lines.text();
}

std::string colour_text(const std::string& name, const WindowContents& window) {
  const Image picture = window.window.picture();
  const Vec3& burr_W = window.simulation->milling.state().record.X_WT.position_mm;
  const Eigen::Vector2d burr = pixel_of(window.view.camera, window.window.size(), burr_W);
  const int x = static_cast<int>(burr.x()), y = static_cast<int>(burr.y());
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return name + ".colour=none\n";
  const unsigned char* colour = picture.pixel(x, y);
  return fmt::format("{}.colour={} {} {}\n", name, colour[0], colour[1], colour[2]);
}

}  // namespace osteomill::app
