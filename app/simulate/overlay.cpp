#include <algorithm>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/visual/annotations.h"

#include "app/simulate/panels.h"
#include "app/simulate/theme.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr const char* kControls[][2] = {
    {"Turn, pan, zoom the view", "left drag, middle (or Shift+left) drag, right drag or wheel"},
    {"Take the tool, let it go", "T (or drag the tool itself)"},
    {"Bring it to the bone under the pointer", "B"},
    {"Move it", "mouse, or arrow keys"},
    {"Press it in, pull it back", "wheel, or W and S, or Page Up and Page Down"},
    {"Turn it", "Shift and mouse, or Shift and arrow keys"},
    {"Mill", "left button while you hold the tool; Space switches the spindle on and off"},
    {"Move a cut, change its greys", "Ctrl and left drag on it; Ctrl and right drag on it"},
    {"See the burr through bone in front of it", "X"},
    {"Follow the burr, loupe, measure", "V, L, R and click two points of bone"},
    {"Choose a piece of bone to keep or remove", "right-click it"},
    {"Pause; undo the last cut, redo it", "P; Ctrl+Z, Ctrl+Y"},
    {"Full screen, this page", "F11, F1"},
    {"With a SpaceMouse", "push and twist it; a button switches the spindle on and off"},
    {"With a game controller",
     "left stick moves, right stick turns, triggers press in and pull back; A mills, B lets go, X undoes "
     "the last cut"},
    {"With a haptic device",
     "first button mills; while you hold C or the second, your hand moves and the tool stays"},
};

// One ID for all dialogues: two at once would hide each other.
constexpr const char* kPopup = "###dialogue";

ImVec2 at(const Eigen::Vector2d& place) {
  return {static_cast<float>(place.x()), static_cast<float>(place.y())};
}

// Draws text with a dark outline, so that it is legible in front of bone.
void draw(ImDrawList& list, Annotation annotation) {
  constexpr ImU32 kDark = IM_COL32(0, 0, 0, 190);
  constexpr ImU32 kLight = IM_COL32(236, 238, 242, 255);
  for (Annotation::Line& line : annotation.lines)
    line = {static_cast<double>(ui::px(1)) * line.from, static_cast<double>(ui::px(1)) * line.to};
  annotation.text_centre_px *= static_cast<double>(ui::px(1));
  for (const Annotation::Line& line : annotation.lines)
    list.AddLine(at(line.from), at(line.to), kDark, ui::px(4));
  for (const Annotation::Line& line : annotation.lines)
    list.AddLine(at(line.from), at(line.to), kLight, ui::px(2));
  const char* text = annotation.text.c_str();
  const ImVec2 size = ImGui::CalcTextSize(text);
  const ImVec2 middle = at(annotation.text_centre_px);
  const ImVec2 place(middle.x - 0.5f * size.x, middle.y - 0.5f * size.y);
  const float aside = ui::px(1);
  for (const float x : {-aside, aside})
    for (const float y : {-aside, aside}) list.AddText({place.x + x, place.y + y}, kDark, text);
  list.AddText(place, kLight, text);
}

}  // namespace

void draw_annotations(const ViewState& view, const PixelSize& size, bool patient) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  // Size of the window in units of the usual text size.
  const PixelSize usual{static_cast<int>(static_cast<float>(size.width) / ui::px(1)),
                        static_cast<int>(static_cast<float>(size.height) / ui::px(1))};
  draw(list, scale_bar_annotation(view.camera, usual));
  if (!patient) return;
  // Left of the right column, which may extend down to the corner.
  const int column = static_cast<int>(ui::kSidePanelWidth_px) + 8;
  for (const Annotation& letter : orientation_letters(view.camera, {usual.width - column, usual.height}))
    draw(list, letter);
}

void draw_help(ViewState& view, const PixelSize& size, const VerticalSpan& span) {
  if (!view.help) return;
  // Next to the bone and tool that the help explains.
  const float width = ui::px(ui::kSidePanelWidth_px);
  const auto width_px = static_cast<float>(size.width);
  ImGui::SetNextWindowPos({width_px - width - ui::px(8), span.top_px});
  ImGui::SetNextWindowSizeConstraints({width, 0},
                                      {width, std::max(span.bottom_px - span.top_px, ui::px(60))});
  ImGui::Begin("How to mill", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  if (ui::button("Start milling", "Closes this page; F1 shows it again")) view.help = false;
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(
      "Gold and grey: the tool, which bone stops. Blue: your hand; the deeper it is in the bone, the harder "
      "you press. Green arrow: force on your hand. Amber arrow: torque. Red point: where they act (with 1 "
      "line-proxy: where bone holds the shaft, if it does).");
  // Tight spacing, so that everything fits into a window of the usual size.
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {ui::px(8), ui::px(1)});
  for (const auto& [what, how] : kControls) {
    ImGui::TextUnformatted(what);
    ImGui::PushStyleColor(ImGuiCol_Text, ui::ink(ui::Ink::note));
    ImGui::TextWrapped("%s", how);
    ImGui::PopStyleColor();
  }
  ImGui::PopStyleVar();
  ImGui::PopTextWrapPos();
  ImGui::End();
  if (is_dialogue_open() || ImGui::GetIO().WantTextInput) return;
  if (ui::is_key_pressed(GLFW_KEY_ENTER) || ui::is_key_pressed(GLFW_KEY_ESCAPE)) view.help = false;
}

void draw_hand(const ViewState& view) {
  if (!view.holding_tool) return;
  const float line_px = ImGui::GetTextLineHeight();
  ui::badge("You hold the tool: T or Esc lets it go", ImGui::GetIO().DisplaySize.y - 3.5f * line_px,
            0.5f * line_px, IM_COL32(40, 70, 100, 230), false);
}

std::string recording_text(double recording_s) {
  const auto whole_s = static_cast<int>(recording_s);
  return fmt::format("REC {}:{:02}", whole_s / 60, whole_s % 60);
}

void draw_recording(double recording_s) {
  const float margin_px = 0.5f * ImGui::GetTextLineHeight();
  ui::badge(recording_text(recording_s), ui::px(8), margin_px, IM_COL32(200, 30, 30, 255), true);
}

bool is_dialogue_open() {
  return ImGui::IsPopupOpen(kPopup) || ImGui::IsPopupOpen(kOpenPopup);
}

void draw_dialogue(DialogueQueue& dialogues) {
  const Dialogue* const shown = dialogues.current();
  if (shown != nullptr && !ImGui::IsPopupOpen(kPopup)) ImGui::OpenPopup(kPopup);
  const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5f, 0.5f});
  const std::string title = (shown != nullptr ? shown->title : "") + kPopup;
  if (!ImGui::BeginPopupModal(title.c_str(), nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  if (shown == nullptr) {
    ImGui::CloseCurrentPopup();
  } else {
    ImGui::PushTextWrapPos(34 * ImGui::GetFontSize());
    ImGui::TextUnformatted(shown->text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    std::vector<ui::Choice> choices;
    for (const Dialogue::Choice& choice : shown->choices) choices.push_back({choice.label, choice.hint});
    if (const auto chosen = ui::choice(choices, shown->is_list)) dialogues.choose(*chosen);
  }
  ImGui::EndPopup();
}

bool draw_loading(const std::string& what, double share_done, double passed_s, const PixelSize& size,
                  bool above) {
  const ImVec2 middle(0.5f * static_cast<float>(size.width), 0.5f * static_cast<float>(size.height));
  ImGui::SetNextWindowPos({middle.x, above ? ui::px(8) : middle.y}, ImGuiCond_Always,
                          {0.5f, above ? 0.0f : 0.5f});
  ImGui::Begin("Opening", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::Text("%s", what.c_str());
  ImGui::ProgressBar(static_cast<float>(share_done), {ui::px(360), 0});
  ImGui::Text("%.0f s", passed_s);
  ImGui::SameLine();
  const bool given_up = ui::button("Cancel", "Stops opening this scan") ||
                        (!is_dialogue_open() && ui::is_key_pressed(GLFW_KEY_ESCAPE));
  ImGui::End();
  return given_up;
}

}  // namespace osteomill::app
