#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace osteomill::testing_support {

/// Returns the folder of the real scans, beside the checkout; they are not part of the project.
inline std::filesystem::path shared_data() {
  return OSTEOMILL_SHARED_DATA;
}

}  // namespace osteomill::testing_support

/// Skips a test, with a message, if the real scan `relative` is not on this machine.
#define OSTEOMILL_NEEDS_SHARED(relative)                                                            \
  do {                                                                                              \
    if (!std::filesystem::exists(osteomill::testing_support::shared_data() / (relative))) {         \
      GTEST_SKIP() << "needs " << (osteomill::testing_support::shared_data() / (relative)).string() \
                   << ", which is not on this machine; the built-in tooth carries the rest";        \
    }                                                                                               \
  } while (false)
