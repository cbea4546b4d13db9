#include "osteomill/report/valid_utf8.h"

#include <gtest/gtest.h>

#include "osteomill/report/html.h"

namespace osteomill {
namespace {

TEST(ValidUtf8, WhatIsSoundStays) {
  for (const char* text : {"", "Zahn", "\xC3\xBC \xE2\x82\xAC \xF0\x9F\xA6\xB7", "\xED\x9F\xBF\xEE\x80\x80"})
    EXPECT_EQ(valid_utf8(text), text);
}

TEST(ValidUtf8, EachByteThatIsNotIsReplaced) {
  const std::string one = "\xEF\xBF\xBD";
  EXPECT_EQ(valid_utf8("Z\xFC"
                       "g"),
            "Z" + one + "g");                    // Latin-1
  EXPECT_EQ(valid_utf8("\xC3"), one);            // cut short
  EXPECT_EQ(valid_utf8("\xC0\xAF"), one + one);  // longer than needed
  EXPECT_EQ(valid_utf8("\xE0\x80\x80"), one + one + one);
  EXPECT_EQ(valid_utf8("\xED\xA0\x80"), one + one + one);  // half of a pair
  EXPECT_EQ(valid_utf8("\xF4\x90\x80\x80"), one + one + one + one);
}

TEST(ValidUtf8, APageIs) {
  const std::string page = html_page("Z\xFC", {});
  EXPECT_EQ(page, valid_utf8(page));
}

}  // namespace
}  // namespace osteomill
