#include "report/page_assets.h"

#include "osteomill/study/embedded_file.h"

// NOLINTBEGIN
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(three_js, OSTEOMILL_THREE_JS)
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(orbit_controls_js, OSTEOMILL_ORBIT_CONTROLS_JS)
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(bone_view_js, OSTEOMILL_ASSETS "/bone_view.js")
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(bone_view_css, OSTEOMILL_ASSETS "/bone_view.css")
// NOLINTEND
