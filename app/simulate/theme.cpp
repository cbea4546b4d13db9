#include "app/simulate/theme.h"

#include <cstddef>

namespace osteomill::app {

namespace {

Theme theme_of_all = Theme::dark;

void colour(ImGuiStyle& style, ImGuiCol which, float red, float green, float blue, float opacity = 1) {
  style.Colors[which] = ImVec4(red, green, blue, opacity);
}

// The slider grips contrast with the numbers drawn over them.
void set_dark(ImGuiStyle& style) {
  ImGui::StyleColorsDark(&style);
  colour(style, ImGuiCol_WindowBg, 0.09f, 0.10f, 0.12f, 0.92f);
  colour(style, ImGuiCol_PopupBg, 0.11f, 0.12f, 0.14f);
  colour(style, ImGuiCol_MenuBarBg, 0.13f, 0.15f, 0.18f);
  colour(style, ImGuiCol_Header, 0.20f, 0.30f, 0.40f, 0.7f);
  colour(style, ImGuiCol_SliderGrab, 0.24f, 0.42f, 0.63f);
  colour(style, ImGuiCol_SliderGrabActive, 0.27f, 0.46f, 0.68f);
  colour(style, ImGuiCol_TextDisabled, 0.62f, 0.64f, 0.67f);
  // Darkens the window behind a dialogue; ImGui's default would lighten it.
  colour(style, ImGuiCol_ModalWindowDimBg, 0, 0, 0, 0.5f);
}

void set_light(ImGuiStyle& style) {
  ImGui::StyleColorsLight(&style);
  colour(style, ImGuiCol_Text, 0.08f, 0.09f, 0.11f);
  colour(style, ImGuiCol_TextDisabled, 0.36f, 0.38f, 0.42f);
  colour(style, ImGuiCol_WindowBg, 0.95f, 0.96f, 0.97f, 0.95f);
  colour(style, ImGuiCol_PopupBg, 0.99f, 0.99f, 1.0f);
  colour(style, ImGuiCol_FrameBg, 0.83f, 0.86f, 0.90f);
  colour(style, ImGuiCol_Header, 0.70f, 0.80f, 0.90f);
  colour(style, ImGuiCol_Button, 0.76f, 0.84f, 0.92f);
  colour(style, ImGuiCol_ButtonHovered, 0.63f, 0.77f, 0.92f);
  colour(style, ImGuiCol_TitleBgActive, 0.74f, 0.80f, 0.87f);
  colour(style, ImGuiCol_TitleBg, 0.84f, 0.87f, 0.91f);
  colour(style, ImGuiCol_SliderGrab, 0.56f, 0.72f, 0.90f);
  colour(style, ImGuiCol_SliderGrabActive, 0.50f, 0.68f, 0.90f);
  colour(style, ImGuiCol_CheckMark, 0.05f, 0.30f, 0.60f);
  colour(style, ImGuiCol_PlotHistogram, 0.30f, 0.45f, 0.65f);
}

// Colours on dark and on light panels.
const ImVec4 kInks[][2] = {{{1.0f, 0.72f, 0.25f, 1}, {0.58f, 0.33f, 0.0f, 1}},
                           {{1.0f, 0.38f, 0.30f, 1}, {0.75f, 0.08f, 0.05f, 1}},
                           {{0.55f, 0.90f, 0.60f, 1}, {0.05f, 0.42f, 0.15f, 1}},
                           {{0.55f, 0.80f, 1.0f, 1}, {0.05f, 0.35f, 0.65f, 1}},
                           {{0.30f, 0.85f, 0.40f, 1}, {0.05f, 0.48f, 0.18f, 1}},
                           {{0.98f, 0.76f, 0.25f, 1}, {0.62f, 0.38f, 0.0f, 1}}};

}  // namespace

void set_theme(Theme theme, float scale) {
  theme_of_all = theme;
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  if (theme == Theme::dark)
    set_dark(style);
  else
    set_light(style);
  style.WindowRounding = 5;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.WindowBorderSize = 0;
  style.ScaleAllSizes(scale);
}

ImVec4 ui::ink(Ink kind) {
  return kInks[static_cast<std::size_t>(kind)][static_cast<std::size_t>(theme_of_all)];
}

}  // namespace osteomill::app
