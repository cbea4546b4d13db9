#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

namespace osteomill::app::ui {

/// The functions below draw ImGui's widgets and note their places, so that a WindowDriver finds a widget by
/// its label (the text before "##"). `hint` is shown if the pointer rests on the widget: a sentence that
/// stands alone.
struct WidgetState {
  ImVec2 middle;
  /// In which of ImGui's frames it was drawn last.
  int frame = 0;
  /// It was used at least once: a button pressed, a slider moved. Tests find by it what they never use.
  bool was_used = false;
  std::string hint = {};
  /// Its label does not fit into it, or it reaches beyond its panel.
  bool is_cut_off = false;
};
std::map<std::string, WidgetState>& widget_states();

/// Pixels for a length that is `length` pixels if text has its usual size.
float px(float length);
void set_scale(double scale);
/// The width of the column on the right, at the usual size of text.
inline constexpr float kSidePanelWidth_px = 250;
/// Returns whether the key (GLFW's number) went down in this picture.
bool is_key_pressed(int key);
/// Returns whether a mouse button went up in this picture without having dragged anything.
bool is_click(ImGuiMouseButton button);

/// Begins a panel of the right column, with its upper edge at `y_px`. `open`: whether it is more than its
/// title.
void begin_side_panel(const char* title, float y_px, bool* open = nullptr, ImGuiWindowFlags flags = 0);
/// Ends it. Returns where the next panel below may begin.
float end_side_panel();
/// Begins an ImGui window that is more than its title as long as `open`. Returns whether it is.
bool begin_panel(const char* title, bool& open, ImGuiWindowFlags flags);

bool button(const char* label, const std::string& hint, bool enabled = true);
bool checkbox(const char* label, const std::string& hint, bool* value);
bool radio(const char* label, const std::string& hint, bool chosen);
bool slider(const char* label, const std::string& hint, float* value, float min, float max,
            const char* format, ImGuiSliderFlags flags = 0);
/// Draws a line of a list. Returns true if it was chosen and was not before.
bool entry(const char* label, const std::string& hint, bool chosen);
/// Draws a text field. Returns true if Enter was pressed in it.
bool text_field(const char* label, const std::string& hint, char* text, std::size_t size,
                ImGuiInputTextFlags flags = 0);
/// Draws a line of a list as wide as the list. Returns true if it was clicked.
bool row(const char* label, const std::string& hint, bool selected);
/// Draws the heading of a group. `open`: whether the group is shown below it, as the user left it.
bool header(const char* label, const std::string& hint, bool& open);
/// Draws a word of a menu bar. Returns true while its menu is open; ImGui::EndMenu ends it.
bool begin_menu(const char* label, const std::string& hint);
/// Goes on in the same line if a widget with this label has room there.
void same_line_if_room(const std::string& label);
/// A dialogue's button.
struct Choice {
  std::string label;
  std::string hint;
};
/// A dialogue's buttons in a row, or each in a line of its own; Enter presses the first, Esc the last.
/// Returns the number of the one that was pressed.
std::optional<std::size_t> choice(const std::vector<Choice>& choices, bool is_list = false);
/// White text on a rounded rectangle over everything else, `top_px` below the middle of the window's upper
/// edge; with a dot before it if something is going on.
void badge(const std::string& text, float top_px, float margin_px, ImU32 ground, bool dot);
/// Explains the text drawn last if the pointer rests on it.
void tooltip(const std::string& text);
/// Text in the colour of warnings, wrapped to the panel.
void warning(const std::string& text);

}  // namespace osteomill::app::ui
