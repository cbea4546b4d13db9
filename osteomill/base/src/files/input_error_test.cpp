#include "osteomill/base/input_error.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(InputError, ReplacesALineBreakByAQuestionMark) {
  EXPECT_STREQ(InputError("c.toml", "line 1: expected 'true', saw 'tr\n'").what(),
               "c.toml: line 1: expected 'true', saw 'tr?'");
}

}  // namespace
}  // namespace osteomill
