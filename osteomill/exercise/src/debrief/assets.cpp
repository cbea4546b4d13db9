#include "debrief/assets.h"

#include <cstddef>

// A compiler takes minutes for 900 KB of text, the assembler none.
// NOLINTBEGIN
#define OSTEOMILL_ASSET(name, path)                                                          \
  __asm__(".pushsection .rodata\n.global osteomill_" #name "_begin\nosteomill_" #name        \
          "_begin:\n.incbin \"" path "\"\n.global osteomill_" #name "_end\nosteomill_" #name \
          "_end:\n.byte 0\n.popsection\n");                                                  \
  extern "C" const char osteomill_##name##_begin[];                                          \
  extern "C" const char osteomill_##name##_end[];                                            \
  std::string_view osteomill::name() {                                                       \
    return {osteomill_##name##_begin,                                                        \
            static_cast<std::size_t>(osteomill_##name##_end - osteomill_##name##_begin)};    \
  }

// cppcheck-suppress comparePointers
OSTEOMILL_ASSET(three_js, OSTEOMILL_THREE_JS)
// cppcheck-suppress comparePointers
OSTEOMILL_ASSET(orbit_controls_js, OSTEOMILL_ORBIT_CONTROLS_JS)
// cppcheck-suppress comparePointers
OSTEOMILL_ASSET(debrief_js, OSTEOMILL_ASSETS "/debrief.js")
// cppcheck-suppress comparePointers
OSTEOMILL_ASSET(debrief_css, OSTEOMILL_ASSETS "/debrief.css")
// NOLINTEND
