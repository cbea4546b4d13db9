#include "osteomill/study/figure.h"

#include <fstream>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill {
namespace {

std::string failure_of(const TemporaryFolder& work, const std::string& script, const std::string& program) {
  try {
    run_gnuplot(work.path(), script, program);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Gnuplot, RunsInTheGivenFolder) {
  const TemporaryFolder work;
  run_gnuplot(work.path(), "set print 'said'\nprint 6*7\n");
  std::string said;
  std::ifstream(work / "said") >> said;
  EXPECT_EQ(said, "42");
}

TEST(Gnuplot, ReportsAMissingProgram) {
  const TemporaryFolder work;
  const std::string failure = failure_of(work, "", "gnuplot-that-is-not-there");
  EXPECT_TRUE(failure.starts_with("gnuplot-that-is-not-there: is not installed")) << failure;
}

TEST(Gnuplot, ReportsItsErrorMessageInOneLine) {
  const TemporaryFolder work;
  const std::string failure = failure_of(work, "set terminal nosuchterminal\n", "gnuplot");
  EXPECT_NE(failure.find("unknown or ambiguous terminal"), std::string::npos) << failure;
  EXPECT_EQ(failure.find('\n'), std::string::npos) << failure;
}

// A quoted text must be printed unchanged, whatever its content.
TEST(Gnuplot, QuotedTextIsPrintedUnchangedAndNotExecuted) {
  const TemporaryFolder work;
  const std::string hostile = R"(it's "a" `touch owned` \n @x ')";
  run_gnuplot(work.path(), "set print 'said'\nprint " + gnuplot_quoted(hostile + "\n\t") + "\n");
  std::string said;
  std::ifstream in(work / "said");
  std::getline(in, said);
  EXPECT_EQ(said, hostile);
  EXPECT_FALSE(std::filesystem::exists(work / "owned"));
}

}  // namespace
}  // namespace osteomill
