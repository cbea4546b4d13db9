#pragma once

#include <string_view>

namespace osteomill {

/// The script and the style of a debriefing's page, as they were when the program was built.
std::string_view debrief_js();
std::string_view debrief_css();

}  // namespace osteomill
