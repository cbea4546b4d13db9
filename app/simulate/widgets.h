#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

namespace osteomill::app::ui {

/// The functions below draw ImGui's widgets and note their places, so that a WindowDriver finds a widget by
/// its label (the text before "##").
struct WidgetState {
  ImVec2 middle;
  /// In which of ImGui's frames it was drawn last.
  int frame = 0;
  /// It was used at least once: a button pressed, a slider moved. Tests find by it what they never use.
  bool was_used = false;
};
std::map<std::string, WidgetState>& widget_states();

/// Pixels for a length that is `length` pixels if text has its usual size.
float px(float length);
void set_scale(double scale);
/// The width of the column on the right, at the usual size of text.
inline constexpr float kSidePanelWidth_px = 250;
/// The colour of warnings.
inline const ImVec4 kWarning{1.0f, 0.72f, 0.25f, 1};

/// Returns whether the key (GLFW's number) went down in this picture.
bool is_key_pressed(int key);

/// Begins a panel of the right column, with its upper edge at `y_px`.
void begin_side_panel(const char* title, float y_px, ImGuiWindowFlags flags = 0);
/// Ends it. Returns where the next panel below may begin.
float end_side_panel();

bool button(const char* label, bool enabled = true);
bool checkbox(const char* label, bool* value);
bool radio(const char* label, bool chosen);
bool slider(const char* label, float* value, float min, float max, const char* format,
            ImGuiSliderFlags flags = 0);
/// Draws a line of a list. Returns true if it was chosen and was not before.
bool entry(const char* label, bool chosen);
/// Draws a text field. Returns true if Enter was pressed in it.
bool text_field(const char* label, char* text, std::size_t size);
bool header(const char* label, bool open);
/// A dialogue's buttons in a row; Enter presses the first, Esc the last. Returns the number of the one that
/// was pressed.
std::optional<std::size_t> choice(const std::vector<std::string>& labels);
/// White text on a rounded rectangle over everything else, `top_px` below the middle of the window's upper
/// edge; with a dot before it if something is going on.
void badge(const std::string& text, float top_px, float margin_px, ImU32 ground, bool dot);
/// Explains the widget drawn last if the pointer rests on it.
void tooltip(const std::string& text);
/// Text in the colour of warnings, wrapped to the panel.
void warning(const std::string& text);

}  // namespace osteomill::app::ui
