#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/device/latest_value.h"
#include "osteomill/live/spsc_ring.h"

namespace osteomill {
namespace {

TEST(SpscRing, KeepsItsOrderAndItsCapacity) {
  SpscRing<std::unique_ptr<int>> ring(2);
  EXPECT_TRUE(ring.try_push(std::make_unique<int>(1)));
  EXPECT_TRUE(ring.try_push(std::make_unique<int>(2)));
  EXPECT_FALSE(ring.has_room());
  auto third = std::make_unique<int>(3);
  EXPECT_FALSE(ring.try_push(std::move(third)));
  ASSERT_TRUE(third);
  EXPECT_EQ(**ring.try_pop(), 1);
  EXPECT_TRUE(ring.try_push(std::move(third)));
  EXPECT_EQ(**ring.try_pop(), 2);
  EXPECT_EQ(**ring.try_pop(), 3);
  EXPECT_FALSE(ring.try_pop());
}

TEST(SpscRing, NothingIsLostBetweenTwoThreads) {
  SpscRing<int> ring(7);
  constexpr int kCount = 20000;
  std::thread sender([&] {
    for (int n = 0; n < kCount;) {
      if (ring.try_push(int(n))) {
        ++n;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (int expected = 0; expected < kCount;) {
    if (const auto value = ring.try_pop()) {
      ASSERT_EQ(*value, expected++);
    } else {
      std::this_thread::yield();
    }
  }
  sender.join();
}

TEST(LatestValue, IsTheNewestAndNeverHalfOfTwo) {
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
