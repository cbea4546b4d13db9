#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/base/latest_value.h"
#include "osteomill/base/spsc_queue.h"

namespace osteomill {
namespace {

TEST(SpscQueue, KeepsOrderAndRefusesPushWhenFull) {
  SpscQueue<std::unique_ptr<int>> queue(3);
  EXPECT_EQ(queue.front(), nullptr);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(queue.try_push(std::make_unique<int>(n)));
  auto late = std::make_unique<int>(3);
  EXPECT_FALSE(queue.try_push(std::move(late)));
  ASSERT_TRUE(late);
  std::unique_ptr<int> value;
  ASSERT_TRUE(queue.try_pop(value));
  EXPECT_EQ(*value, 0);
  EXPECT_TRUE(queue.try_push(std::move(late)));
  EXPECT_EQ(**queue.front(), 1);
  queue.pop();
  ASSERT_TRUE(queue.try_pop(value));
  EXPECT_EQ(*value, 2);
  ASSERT_TRUE(queue.try_pop(value));
  EXPECT_EQ(*value, 3);
  EXPECT_FALSE(queue.try_pop(value));
}

TEST(SpscQueue, DeliversEveryValueInOrderBetweenTwoThreads) {
  SpscQueue<int> queue(7);
  constexpr int kCount = 20000;
  std::thread sender([&] {
    for (int n = 0; n < kCount;) {
      if (queue.try_push(n)) {
        ++n;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (int expected = 0; expected < kCount;) {
    if (int value = 0; queue.try_pop(value)) {
      ASSERT_EQ(value, expected++);
    } else {
      std::this_thread::yield();
    }
  }
  sender.join();
}

TEST(LatestValue, ReadsTheNewestValueWithoutTearing) {
  struct Pair {
    long a = 0;
    long b = 0;
  };
  LatestValue<Pair> latest;
  EXPECT_EQ(latest.read().a, 0);
  constexpr long kCount = 100000;
  std::thread writer([&] {
    for (long n = 1; n <= kCount; ++n) latest.write({n, -n});
  });
  long last = 0;
  while (last < kCount) {
    const Pair seen = latest.read();
    ASSERT_EQ(seen.a, -seen.b);
    ASSERT_GE(seen.a, last);
    last = seen.a;
    std::this_thread::yield();
  }
  writer.join();
  EXPECT_EQ(latest.read().a, kCount);
}

}  // namespace
}  // namespace osteomill
