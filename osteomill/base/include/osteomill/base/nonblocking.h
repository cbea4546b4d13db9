#pragma once

/// Expands to `[[clang::nonblocking]]` if the compiler supports it (clang 20 and later). Written after
/// `noexcept`, it marks the functions that the haptic tick calls, so that -Wfunction-effects and the
/// real-time sanitizer also check third-party implementations and programs.
#ifdef __has_cpp_attribute
#if __has_cpp_attribute(clang::nonblocking)
#define OSTEOMILL_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef OSTEOMILL_NONBLOCKING
#define OSTEOMILL_NONBLOCKING
#endif
