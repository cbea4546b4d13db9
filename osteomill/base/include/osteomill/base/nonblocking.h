#pragma once

/// `[[clang::nonblocking]]` if the compiler knows it (clang 20 and later): behind `noexcept` it marks what
/// the haptic tick calls, so that -Wfunction-effects and the real-time sanitizer look into implementations
/// and programs of others too.
#ifdef __has_cpp_attribute
#if __has_cpp_attribute(clang::nonblocking)
#define OSTEOMILL_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef OSTEOMILL_NONBLOCKING
#define OSTEOMILL_NONBLOCKING
#endif
