#include "app/simulate/widgets.h"

#include <algorithm>

#include <GLFW/glfw3.h>

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

// Remembers the widget drawn last. Returns whether it acted.
bool remember(const char* label, bool acted) {
  std::string text(label);
  text.erase(std::min(text.find("##"), text.size()));
  const ImVec2 min = ImGui::GetItemRectMin();
  const ImVec2 max = ImGui::GetItemRectMax();
  WidgetState& state = widget_states()[text];
  state = {{0.5f * (min.x + max.x), 0.5f * (min.y + max.y)}, ImGui::GetFrameCount(), state.was_used || acted};
  return acted;
}

}  // namespace

bool is_key_pressed(int key) {
  return ImGui::IsKeyPressed(key, false);
}

void begin_side_panel(const char* title, float y_px, ImGuiWindowFlags flags) {
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - px(kSidePanelWidth_px + 8), y_px});
  ImGui::SetNextWindowSize({px(kSidePanelWidth_px), 0});
  ImGui::Begin(title, nullptr, flags | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
}

float end_side_panel() {
  const float below_px = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + px(8);
  ImGui::End();
  return below_px;
}

bool button(const char* label, bool enabled) {
  if (!enabled) ImGui::BeginDisabled();
  const bool acted = remember(label, ImGui::Button(label) && enabled);
  if (!enabled) ImGui::EndDisabled();
  return acted;
}

bool checkbox(const char* label, bool* value) {
  return remember(label, ImGui::Checkbox(label, value));
}

bool radio(const char* label, bool chosen) {
  return remember(label, ImGui::RadioButton(label, chosen) && !chosen);
}

bool slider(const char* label, float* value, float min, float max, const char* format,
            ImGuiSliderFlags flags) {
  return remember(label, ImGui::SliderFloat(label, value, min, max, format, flags));
}

bool entry(const char* label, bool chosen) {
  return remember(label, ImGui::Selectable(label, chosen, 0, {px(150), 0}) && !chosen);
}

bool text_field(const char* label, char* text, std::size_t size) {
  return remember(label, ImGui::InputText(label, text, size, ImGuiInputTextFlags_EnterReturnsTrue));
}

bool header(const char* label, bool open) {
  const bool shown = ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  remember(label, ImGui::IsItemToggledOpen());
  return shown;
}

std::optional<std::size_t> choice(const std::vector<std::string>& labels) {
  std::optional<std::size_t> chosen;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (n > 0) ImGui::SameLine();
    if (button(labels[n].c_str())) chosen = n;
  }
  if (labels.empty()) return chosen;
  // The key that led to the dialogue may still be going down.
  if (ImGui::IsWindowAppearing()) return chosen;
  if (is_key_pressed(GLFW_KEY_ENTER) || is_key_pressed(GLFW_KEY_KP_ENTER)) chosen = 0;
  if (is_key_pressed(GLFW_KEY_ESCAPE)) chosen = labels.size() - 1;
  if (chosen) widget_states()[labels[*chosen]].was_used = true;
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
  ImGui::PushStyleColor(ImGuiCol_Text, kWarning);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

void tooltip(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(25 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace osteomill::app::ui
