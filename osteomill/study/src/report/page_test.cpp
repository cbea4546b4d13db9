#include "osteomill/study/page.h"

#include <limits>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

TEST(Html, EncodesBase64AsInRfc4648) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\x00\xfe", 3)), "/wD+");
}

TEST(Html, EscapesMarkupInText) {
  EXPECT_EQ(html_escaped("<b a=\"1\">&amp;</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;amp;&lt;/b&gt;");
}

TEST(Html, RendersCellPartsWithTheirStyles) {
  const Section section{
      .tables = {{{"<a>"}, {{"x & y", Cell({{"1 > 2", CellStyle::strong}, {"\nno", CellStyle::faint}})}}}}};
  const std::string page = html(section);
  EXPECT_NE(page.find("<th>&lt;a&gt;</th>"), std::string::npos) << page;
  EXPECT_NE(page.find("<th>x &amp; y</th><td><span class=\"strong\">1 &gt; 2</span><span "
                      "class=\"faint\"><br>no</span></td>"),
            std::string::npos)
      << page;
}

TEST(Html, EscapesPageDataThatWouldEndItsScript) {
  const Page page{.title = "Task",
                  .sections = {{.title = "Course", .id = "course"}},
                  .style = ".x > .y {}",
                  .scripts = {"go(1 < 2);"},
                  .data = R"json({"name":"</script><script>alert(1)"})json"};
  const std::string text = html(page);
  EXPECT_NE(text.find(R"json({"name":"\u003c/script>\u003cscript>alert(1)"}</script>)json"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("<div id=\"course\">\n<h2>Course</h2>\n</div>"), std::string::npos) << text;
  EXPECT_NE(text.find("<script>go(1 < 2);</script>"), std::string::npos) << text;
  EXPECT_NE(text.find(".x > .y {}</style>"), std::string::npos) << text;
}

TEST(PlainText, AlignsColumnsOfUtf8AndMultilineCells) {
  const Table table{{"a", "bb"}, {{"µm", "x\ny"}, {"long", Cell({{"1"}, {"2"}})}}};
  EXPECT_EQ(plain_text(table), "a     bb\nµm    x\n      y\nlong  12\n");
}

TEST(PlainText, WrapsLinesThatAreTooWide) {
  const std::string text = plain_text({{"", ""}, {{"a", std::string(70, 'b') + " " + std::string(70, 'c')}}});
  EXPECT_NE(text.find("a  bbb"), std::string::npos) << text;
  EXPECT_NE(text.find("b\n   ccc"), std::string::npos) << text;
}

TEST(Shown, RoundsFractionsToFourDigitsAndUsesNoExponent) {
  EXPECT_EQ(shown(0.12345), "0.1235");
  EXPECT_EQ(shown(312500.4), "312500");
  EXPECT_EQ(shown(std::numeric_limits<double>::quiet_NaN()), "–");
}

TEST(Html, RefusesAMissingFigure) {
  EXPECT_THROW(html(Section{.figures = {{"/no/such/figure.svg", "x"}}}), InputError);
}

}  // namespace

namespace {

TEST(ValidUtf8, KeepsValidText) {
  for (const char* text : {"", "Zahn", "\xC3\xBC \xE2\x82\xAC \xF0\x9F\xA6\xB7", "\xED\x9F\xBF\xEE\x80\x80"})
    EXPECT_EQ(valid_utf8(text), text);
}

TEST(ValidUtf8, ReplacesEachInvalidByte) {
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

TEST(ValidUtf8, HtmlPageIsValidEvenIfItsTitleIsNot) {
  const std::string page = html(Page{"Z\xFC", {}});
  EXPECT_EQ(page, valid_utf8(page));
}

}  // namespace

}  // namespace osteomill
