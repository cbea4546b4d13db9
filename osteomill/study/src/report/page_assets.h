#pragma once

#include <string_view>

namespace osteomill {

/// three.js with its orbit controls, and osteomill's own script and style for bones.
std::string_view three_js();
std::string_view orbit_controls_js();
std::string_view bone_view_js();
std::string_view bone_view_css();

}  // namespace osteomill
