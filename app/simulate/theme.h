#pragma once

#include <imgui.h>

namespace osteomill::app {

/// The colours of the panels. The view of the bone keeps its own.
enum class Theme { dark, light };

/// Sets ImGui's colours and sizes, with everything `scale` times as large as usual.
void set_theme(Theme theme, float scale);

namespace ui {

/// Kinds of coloured text and lines. Each is readable on the panels of either theme.
enum class Ink { warning, danger, good, note, force, torque };
/// Returns its colour in the theme that is set.
ImVec4 ink(Ink kind);

}  // namespace ui

}  // namespace osteomill::app
