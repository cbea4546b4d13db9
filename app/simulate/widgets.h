#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

namespace osteomill::app::ui {

/// ImGui's widgets, which remember where they were drawn, so that a script finds them by their label (what
/// stands before "##").
struct Place {
  ImVec2 middle;
  int frame = 0;
  /// It did what it is for at least once: a button was pressed, a slider moved. A test sees by it which never
  /// were.
  bool worked = false;
};
std::map<std::string, Place>& places();

/// A length of the layout, given as it is where text has its usual size.
float px(float length);
void set_scale(double scale);
/// Of what stands below one another on the right, at the usual size of text.
inline constexpr float kRightWidth_px = 250;
/// The colour of what is not as it should be.
inline const ImVec4 kWarning{1.0f, 0.72f, 0.25f, 1};

/// Begins a panel of the right column, with its upper edge at `y_px`.
void begin_right(const char* title, float y_px, ImGuiWindowFlags flags = 0);
/// Ends it. Returns where the next one below has room.
float end_right();

bool button(const char* label, bool enabled = true);
bool checkbox(const char* label, bool* value);
bool radio(const char* label, bool chosen);
bool slider(const char* label, float* value, float min, float max, const char* format,
            ImGuiSliderFlags flags = 0);
/// True when Enter was pressed in it.
bool text_field(const char* label, char* text, std::size_t size);
bool header(const char* label, bool open);
/// A dialogue's buttons in a row, by number the one that was chosen: Enter is the first, Esc the last.
std::optional<std::size_t> choice(const std::vector<std::string>& labels);
/// Words in white on a rounded ground over everything, in the middle of the window, so far below its top;
/// with a dot before them where something is going on.
void badge(const std::string& text, float top_px, float margin_px, ImU32 ground, bool dot);
/// Explains the widget drawn last where the pointer rests on it.
void hint(const char* text);

}  // namespace osteomill::app::ui
