#include "osteomill/report/html.h"

#include <gtest/gtest.h>

#include "osteomill/files/input_error.h"

namespace osteomill {
namespace {

TEST(Html, Base64OfTheStandardsExamples) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Html, TextIsEscaped) {
  EXPECT_EQ(html_escaped("<b a=\"1\">&amp;</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;amp;&lt;/b&gt;");
}

TEST(Html, AFigureThatIsMissingIsNamed) {
  EXPECT_THROW(html({.figures = {{"/no/such/figure.svg", "x"}}}), InputError);
}

}  // namespace
}  // namespace osteomill
