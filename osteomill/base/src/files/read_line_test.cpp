#include "osteomill/base/read_line.h"

#include <sstream>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(ReadLine, StripsTheNewlineButNotACarriageReturn) {
  std::istringstream in("one\n\nthree\r\nlast");
  std::string line;
  for (const char* expected : {"one", "", "three\r", "last"}) {
    ASSERT_TRUE(read_line(in, line, 8));
    EXPECT_EQ(line, expected);
  }
  EXPECT_FALSE(read_line(in, line, 8));
}

TEST(ReadLine, RefusesALineBeyondTheLimit) {
  std::istringstream in(std::string(8, 'a') + "\n" + std::string(100, 'b'));
  std::string line;
  EXPECT_TRUE(read_line(in, line, 8));
  EXPECT_THROW(read_line(in, line, 8), LineTooLong);
  EXPECT_EQ(line.size(), 8u) << "stops reading at the limit";
}

}  // namespace
}  // namespace osteomill
