#pragma once

#include <imgui.h>

namespace osteomill::app {

/// Colour theme of the panels. The view of the bone has its own colours.
enum class Theme { dark, light };

/// Sets ImGui's colours, and its sizes multiplied by `scale`.
void set_theme(Theme theme, float scale);

namespace ui {

/// Kinds of coloured text and lines. Each is legible on the panels of both themes.
enum class Ink { warning, danger, good, note, force, torque };
/// Returns the colour in the current theme.
ImVec4 ink(Ink kind);

}  // namespace ui

}  // namespace osteomill::app
