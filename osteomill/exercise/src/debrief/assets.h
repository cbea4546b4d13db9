#pragma once

#include <string_view>

namespace osteomill {

/// The files that a debriefing's page holds, as they were when the program was built: three.js with its
/// control of the camera by mouse and touch, and our own script and style.
std::string_view three_js();
std::string_view orbit_controls_js();
std::string_view debrief_js();
std::string_view debrief_css();

}  // namespace osteomill
