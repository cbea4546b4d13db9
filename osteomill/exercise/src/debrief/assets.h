#pragma once

#include <string_view>

namespace osteomill {

/// Script and style sheet of a debriefing's page, embedded at build time.
std::string_view debrief_js();
std::string_view debrief_css();

}  // namespace osteomill
