#include "app/simulate/widgets.h"

#include <algorithm>

#include <GLFW/glfw3.h>

#include "app/simulate/theme.h"

namespace osteomill::app::ui {

namespace {

float scale_of_all = 1;

}  // namespace

float px(float length) {
  return length * scale_of_all;
}

void set_scale(double scale) {
  scale_of_all = static_cast<float>(scale);
}

std::map<std::string, WidgetState>& widget_states() {
  static std::map<std::string, WidgetState> kept;
  return kept;
}

namespace {

// Stores the state of the last widget and adds its tooltip. Returns `acted`.
bool note_widget(const char* label, const std::string& hint, bool acted) {
  std::string text(label);
  text.erase(std::min(text.find("##"), text.size()));
  const ImVec2 min = ImGui::GetItemRectMin();
  const ImVec2 max = ImGui::GetItemRectMax();
  const float right_px = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  // A heading extends halfway into the panel's padding.
  const float edge_px = right_px + 0.5f * ImGui::GetStyle().WindowPadding.x + 1;
  const bool is_cut_off = max.x > edge_px || ImGui::CalcTextSize(text.c_str()).x > max.x - min.x;
  WidgetState& state = widget_states()[text];
  state = {{0.5f * (min.x + max.x), 0.5f * (min.y + max.y)},
           ImGui::GetFrameCount(),
           state.was_used || acted,
           hint,
           is_cut_off};
  tooltip(hint);
  return acted;
}

}  // namespace

bool is_key_pressed(int key) {
  return ImGui::IsKeyPressed(key, false);
}

bool is_click(ImGuiMouseButton button) {
  constexpr float kReach_px = 4;
  const float reach_px = px(kReach_px);
  return ImGui::IsMouseReleased(button) &&
         ImGui::GetIO().MouseDragMaxDistanceSqr[button] <= reach_px * reach_px;
}

bool begin_panel(const char* title, bool& open, ImGuiWindowFlags flags) {
  ImGui::SetNextWindowCollapsed(!open);
  open = ImGui::Begin(title, nullptr, flags | ImGuiWindowFlags_NoMove);
  return open;
}

void begin_side_panel(const char* title, float y_px, bool* open, ImGuiWindowFlags flags) {
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - px(kSidePanelWidth_px + 8), y_px});
  ImGui::SetNextWindowSize({px(kSidePanelWidth_px), 0});
  bool always = true;
  begin_panel(title, open != nullptr ? *open : always,
              flags | ImGuiWindowFlags_NoResize | (open == nullptr ? ImGuiWindowFlags_NoCollapse : 0));
}

float end_side_panel() {
  const float below_px = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + px(8);
  ImGui::End();
  return below_px;
}

bool button(const char* label, const std::string& hint, bool enabled) {
  if (!enabled) ImGui::BeginDisabled();
  const bool acted = note_widget(label, hint, ImGui::Button(label) && enabled);
  if (!enabled) ImGui::EndDisabled();
  return acted;
}

bool checkbox(const char* label, const std::string& hint, bool* value) {
  return note_widget(label, hint, ImGui::Checkbox(label, value));
}

bool radio(const char* label, const std::string& hint, bool chosen) {
  return note_widget(label, hint, ImGui::RadioButton(label, chosen) && !chosen);
}

bool slider(const char* label, const std::string& hint, float* value, float min, float max,
            const char* format, ImGuiSliderFlags flags) {
  return note_widget(label, hint, ImGui::SliderFloat(label, value, min, max, format, flags));
}

bool entry(const char* label, const std::string& hint, bool chosen) {
  return note_widget(label, hint, ImGui::Selectable(label, chosen, 0, {px(150), 0}) && !chosen);
}

bool text_field(const char* label, const std::string& hint, char* text, std::size_t size,
                ImGuiInputTextFlags flags) {
  return note_widget(label, hint,
                     ImGui::InputText(label, text, size, flags | ImGuiInputTextFlags_EnterReturnsTrue));
}

bool row(const char* label, const std::string& hint, bool selected) {
  constexpr ImGuiSelectableFlags kFlags =
      ImGuiSelectableFlags_DontClosePopups | ImGuiSelectableFlags_AllowDoubleClick;
  return note_widget(label, hint, ImGui::Selectable(label, selected, kFlags));
}

bool header(const char* label, const std::string& hint, bool& open) {
  ImGui::SetNextItemOpen(open);
  open = ImGui::CollapsingHeader(label);
  note_widget(label, hint, ImGui::IsItemToggledOpen());
  return open;
}

bool begin_menu(const char* label, const std::string& hint) {
  const bool is_open = ImGui::BeginMenu(label);
  // If the menu is open, the last item is the menu's own window.
  if (!is_open) note_widget(label, hint, false);
  if (is_open && ImGui::IsWindowAppearing()) widget_states()[label].was_used = true;
  return is_open;
}

void same_line_if_room(const std::string& label) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float right_px = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  const float width_px =
      ImGui::CalcTextSize(label.c_str()).x + ImGui::GetFrameHeight() + 2 * style.ItemSpacing.x;
  if (ImGui::GetItemRectMax().x + width_px <= right_px) ImGui::SameLine();
}

std::optional<std::size_t> choice(const std::vector<Choice>& choices, bool is_list) {
  std::optional<std::size_t> chosen;
  for (std::size_t n = 0; n < choices.size(); ++n) {
    if (n > 0 && !is_list) ImGui::SameLine();
    if (button(choices[n].label.c_str(), choices[n].hint)) chosen = n;
  }
  if (choices.empty()) return chosen;
  // The key that led to the dialogue may still be down.
  if (ImGui::IsWindowAppearing()) return chosen;
  if (is_key_pressed(GLFW_KEY_ENTER) || is_key_pressed(GLFW_KEY_KP_ENTER)) chosen = 0;
  if (is_key_pressed(GLFW_KEY_ESCAPE)) chosen = choices.size() - 1;
  if (chosen) widget_states()[choices[*chosen].label].was_used = true;
  return chosen;
}

void badge(const std::string& text, float top_px, float margin_px, ImU32 ground, bool dot) {
  constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 255);
  const ImVec2 text_px = ImGui::CalcTextSize(text.c_str());
  const ImVec2 corner(0.5f * (ImGui::GetIO().DisplaySize.x - text_px.x), top_px + margin_px);
  const float before = (dot ? 3 : 2) * margin_px, after = (dot ? 1 : 2) * margin_px;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  list.AddRectFilled({corner.x - before, corner.y - margin_px},
                     {corner.x + text_px.x + after, corner.y + text_px.y + margin_px}, ground, margin_px);
  if (dot) {
    list.AddCircleFilled({corner.x - 1.6f * margin_px, corner.y + 0.5f * text_px.y}, 0.6f * margin_px,
                         kWhite);
  }
  list.AddText(corner, kWhite, text.c_str());
}

void warning(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ink(Ink::warning));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void tooltip(const std::string& text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(25 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace osteomill::app::ui
