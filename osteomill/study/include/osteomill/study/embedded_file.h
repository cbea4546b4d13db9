#pragma once

#include <cstddef>
#include <string_view>

/// Defines `std::string_view osteomill::name()`, which returns the content of a file at build time. Uses the
/// assembler: a compiler takes minutes for a literal of 900 KB.
// NOLINTBEGIN
#define OSTEOMILL_EMBEDDED_FILE(name, path)                                                  \
  __asm__(".pushsection .rodata\n.global osteomill_" #name "_begin\nosteomill_" #name        \
          "_begin:\n.incbin \"" path "\"\n.global osteomill_" #name "_end\nosteomill_" #name \
          "_end:\n.byte 0\n.popsection\n");                                                  \
  extern "C" const char osteomill_##name##_begin[];                                          \
  extern "C" const char osteomill_##name##_end[];                                            \
  std::string_view osteomill::name() {                                                       \
    return {osteomill_##name##_begin,                                                        \
            static_cast<std::size_t>(osteomill_##name##_end - osteomill_##name##_begin)};    \
  }
// NOLINTEND
