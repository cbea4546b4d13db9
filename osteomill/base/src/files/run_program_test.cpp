#include "osteomill/base/run_program.h"

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

namespace osteomill {
namespace {

TEST(RunProgram, ReturnsOutputAndExitCode) {
  const ProcessResult result = run_program({"sh", "-c", "echo out; echo err >&2; cat; exit 3"});
  EXPECT_EQ(result.text, "out\nerr\n") << "with no input";
  EXPECT_EQ(result.exit_code, 3);
}

TEST(RunProgram, PassesArgumentsUnchanged) {
  const std::string hostile = "it's \"a\" $HOME `echo x` \\ ;*";
  EXPECT_EQ(run_program({"printf", "%s|%s", hostile, ""}).text, hostile + "|");
}

TEST(RunProgram, ReportsAMissingProgram) {
  EXPECT_EQ(run_program({"no-such-program-anywhere"}).exit_code, ProcessResult::kNoProgram);
}

TEST(RunProgram, KillsAProgramAndItsChildrenAtTheTimeLimit) {
  try {
    run_program({"sh", "-c", "sleep 1000 & sleep 1000"}, std::chrono::milliseconds(200));
    FAIL() << "it ended";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "sh: did not end within 0.2 s");
  }
}

}  // namespace
}  // namespace osteomill
