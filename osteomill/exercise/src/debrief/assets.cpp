#include "debrief/assets.h"

#include "osteomill/study/embedded_file.h"

// NOLINTBEGIN
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(debrief_js, OSTEOMILL_ASSETS "/debrief.js")
// cppcheck-suppress comparePointers
OSTEOMILL_EMBEDDED_FILE(debrief_css, OSTEOMILL_ASSETS "/debrief.css")
// NOLINTEND
