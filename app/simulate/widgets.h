#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

namespace osteomill::app::ui {

/// The functions below draw ImGui widgets and note their positions, so that a WindowDriver finds a widget by
/// its label (the text before "##"). `hint` is its tooltip: a sentence that stands alone.
struct WidgetState {
  ImVec2 middle;
  /// The ImGui frame in which it was last drawn.
  int frame = 0;
  /// Used at least once: a button pressed, a slider moved. Lets tests find widgets that they never use.
  bool was_used = false;
  std::string hint = {};
  /// The label does not fit into the widget, or the widget extends beyond its panel.
  bool is_cut_off = false;
};
std::map<std::string, WidgetState>& widget_states();

/// Converts a length at the usual text size to pixels.
float px(float length);
void set_scale(double scale);
/// Width of the right column at the usual text size.
inline constexpr float kSidePanelWidth_px = 250;
/// Returns whether the key (GLFW's number) was pressed in this frame.
bool is_key_pressed(int key);
/// Returns whether a mouse button was released in this frame without dragging.
bool is_click(ImGuiMouseButton button);

/// Begins a panel of the right column, with its upper edge at `y_px`. `open` tells whether it is expanded.
void begin_side_panel(const char* title, float y_px, bool* open = nullptr, ImGuiWindowFlags flags = 0);
/// Ends the panel. Returns the upper edge of the next panel below.
float end_side_panel();
/// Begins an ImGui window, expanded if `open`. Returns whether it is expanded.
bool begin_panel(const char* title, bool& open, ImGuiWindowFlags flags);

bool button(const char* label, const std::string& hint, bool enabled = true);
bool checkbox(const char* label, const std::string& hint, bool* value);
bool radio(const char* label, const std::string& hint, bool chosen);
bool slider(const char* label, const std::string& hint, float* value, float min, float max,
            const char* format, ImGuiSliderFlags flags = 0);
/// Draws a menu entry. Returns true if it was newly chosen.
bool entry(const char* label, const std::string& hint, bool chosen);
/// Draws a text field. Returns true if Enter was pressed in it.
bool text_field(const char* label, const std::string& hint, char* text, std::size_t size,
                ImGuiInputTextFlags flags = 0);
/// Draws a list entry as wide as the list. Returns true if it was clicked.
bool row(const char* label, const std::string& hint, bool selected);
/// Draws the heading of a group. `open` tells whether the group below it is shown; the user can change it.
bool header(const char* label, const std::string& hint, bool& open);
/// Draws a menu of a menu bar. Returns true while it is open; ImGui::EndMenu ends it.
bool begin_menu(const char* label, const std::string& hint);
/// Continues the same line if a widget with this label fits.
void same_line_if_room(const std::string& label);
/// A button of a dialogue.
struct Choice {
  std::string label;
  std::string hint;
};
/// Draws the buttons of a dialogue, in a row or as a list; Enter presses the first, Esc the last. Returns the
/// number of the pressed one.
std::optional<std::size_t> choice(const std::vector<Choice>& choices, bool is_list = false);
/// Draws white text on a rounded rectangle over everything else, `top_px` below the middle of the window's
/// upper edge; `dot` marks an activity in progress.
void badge(const std::string& text, float top_px, float margin_px, ImU32 ground, bool dot);
/// Adds a tooltip to the text drawn last.
void tooltip(const std::string& text);
/// Draws text in the warning colour, wrapped to the panel.
void warning(const std::string& text);

}  // namespace osteomill::app::ui
