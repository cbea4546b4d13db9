#include "osteomill/base/work_progress.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

void long_work(std::size_t steps) {
  for (std::size_t n = 1; n <= steps; ++n) WorkProgress::done(n, steps);
}

void work_in_two_parts() {
  {
    const WorkProgress::Part part(0.25);
    long_work(2);
  }
  const WorkProgress::Part part(1);
  long_work(3);
}

TEST(WorkProgress, DoesNothingWithoutAListener) {
  EXPECT_NO_THROW(work_in_two_parts());
}

TEST(WorkProgress, PartsAddUpToTheWhole) {
  std::vector<double> reported;
  {
    const WorkProgress progress([&](double share) { reported.push_back(share); });
    work_in_two_parts();
  }
  const std::vector<double> expected{0.125, 0.25, 0.5, 0.75, 1};
  EXPECT_EQ(reported, expected);
  work_in_two_parts();
  EXPECT_EQ(reported.size(), expected.size());
}

TEST(WorkProgress, NestedAndSkippedPartsNeverDecreaseProgress) {
  std::vector<double> reported;
  const WorkProgress progress([&](double share) { reported.push_back(share); });
  {
    const WorkProgress::Part part(0.5);
    work_in_two_parts();
  }
  { const WorkProgress::Part nothing_told_of(0.9); }
  const WorkProgress::Part part(1);
  long_work(1);
  EXPECT_EQ(reported, (std::vector<double>{0.0625, 0.125, 0.25, 0.375, 0.5, 1}));
}

TEST(WorkProgress, ListenerStopsTheWorkByThrowing) {
  int reported = 0;
  const WorkProgress progress([&](double share) {
    ++reported;
    if (share > 0.3) throw WorkStopped();
  });
  EXPECT_THROW(work_in_two_parts(), WorkStopped);
  EXPECT_EQ(reported, 3);
}

TEST(WorkProgress, ReportsTheWorkOfAnotherThread) {
  std::vector<double> reported;
  const WorkProgress progress([&](double share) { reported.push_back(share); });
  {
    const WorkProgress::Part part(0.5);
    const WorkProgress::Listener mine = WorkProgress::of_this_thread();
    std::jthread([&] {
      const WorkProgress there(mine);
      long_work(2);
    }).join();
  }
  EXPECT_EQ(reported, (std::vector<double>{0.25, 0.5}));
}

}  // namespace
}  // namespace osteomill
