#include "app/simulate/widgets.h"

namespace osteomill::app::ui {

std::map<std::string, Place>& places() {
  static std::map<std::string, Place> kept;
  return kept;
}

void remember(const char* label) {
  const std::string text(label);
  const ImVec2 min = ImGui::GetItemRectMin();
  const ImVec2 max = ImGui::GetItemRectMax();
  places()[text.substr(0, text.find("##"))] = {{0.5f * (min.x + max.x), 0.5f * (min.y + max.y)},
                                               ImGui::GetFrameCount()};
}

bool button(const char* label, bool enabled) {
  if (!enabled) ImGui::BeginDisabled();
  const bool pressed = ImGui::Button(label);
  remember(label);
  if (!enabled) ImGui::EndDisabled();
  return pressed && enabled;
}

bool checkbox(const char* label, bool* value) {
  const bool changed = ImGui::Checkbox(label, value);
  remember(label);
  return changed;
}

bool radio(const char* label, bool chosen) {
  const bool pressed = ImGui::RadioButton(label, chosen);
  remember(label);
  return pressed && !chosen;
}

bool slider(const char* label, float* value, float min, float max, const char* format,
            ImGuiSliderFlags flags) {
  const bool changed = ImGui::SliderFloat(label, value, min, max, format, flags);
  remember(label);
  return changed;
}

bool text_field(const char* label, char* text, std::size_t size) {
  const bool entered = ImGui::InputText(label, text, size, ImGuiInputTextFlags_EnterReturnsTrue);
  remember(label);
  return entered;
}

bool header(const char* label, bool open) {
  const bool shown = ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  remember(label);
  return shown;
}

bool released() {
  return ImGui::IsItemDeactivatedAfterEdit();
}

void hint(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

}  // namespace osteomill::app::ui
