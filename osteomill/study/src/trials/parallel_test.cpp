#include "osteomill/study/parallel.h"

#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr std::size_t kTasks = 100;

class RunInParallel : public ::testing::TestWithParam<std::size_t> {};

TEST_P(RunInParallel, RunsEachTaskOnceAndCountsThem) {
  std::vector<std::atomic<int>> runs(kTasks);
  std::vector<std::size_t> counted;
  run_in_parallel(
      kTasks, GetParam(), [&](std::size_t n) { ++runs[n]; }, [&](std::size_t n) { counted.push_back(n); });
  for (const std::atomic<int>& count : runs) EXPECT_EQ(count, 1);
  ASSERT_EQ(counted.size(), kTasks);
  for (std::size_t n = 0; n < kTasks; ++n) EXPECT_EQ(counted[n], n + 1);
}

TEST_P(RunInParallel, RethrowsTheExceptionOfATaskAndStartsNoMore) {
  std::atomic<std::size_t> started = 0;
  const auto fail_from_ten = [&](std::size_t n) {
    ++started;
    if (n >= 10) throw std::runtime_error("ten");
  };
  EXPECT_THROW(run_in_parallel(kTasks, GetParam(), fail_from_ten, [](std::size_t) {}), std::runtime_error);
  // Each thread fails in the first of its tasks from 10 on.
  EXPECT_LE(started, 10 + GetParam());
}

TEST_P(RunInParallel, RethrowsTheExceptionOfTheProgressCallback) {
  std::size_t calls = 0;
  const auto fail_at_ten = [&](std::size_t n) {
    ++calls;
    if (n == 10) throw std::runtime_error("ten");
  };
  EXPECT_THROW(run_in_parallel(
                   kTasks, GetParam(), [](std::size_t) {}, fail_at_ten),
               std::runtime_error);
  EXPECT_EQ(calls, 10u);
}

INSTANTIATE_TEST_SUITE_P(, RunInParallel, ::testing::Values(1, 4));

}  // namespace
}  // namespace osteomill
