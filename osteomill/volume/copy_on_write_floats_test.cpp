#include "osteomill/volume/copy_on_write_floats.h"

#include <cstddef>
#include <numeric>
#include <thread>
#include <vector>

#include "tests/own_memory.h"
#include <gtest/gtest.h>

namespace osteomill {
namespace {

using testing_support::own_memory_MiB;

constexpr std::size_t kCount = 10'000'000;

std::vector<float> ascending(std::size_t count) {
  std::vector<float> values(count);
  std::iota(values.begin(), values.end(), 0.0f);
  return values;
}

TEST(CopyOnWriteFloats, HoldsWhatItWasGiven) {
  for (const std::size_t count : {1, 15, 1023, 1024, 1025, 5'000'000}) {
    const std::vector<float> values = ascending(count);
    const CopyOnWriteFloats floats(values);
    EXPECT_TRUE(std::equal(floats.begin(), floats.end(), values.begin(), values.end())) << count;
  }
  EXPECT_TRUE(CopyOnWriteFloats(std::vector<float>()).empty());
}

TEST(CopyOnWriteFloats, CopiesDifferInWhatWasWrittenAlone) {
  CopyOnWriteFloats first(ascending(5000));
  first.set(4096, -1);
  CopyOnWriteFloats second = first;
  first.set(0, -2);
  second.set(4999, -3);
  const CopyOnWriteFloats third = second;
  second.set(4999, -4);
  std::vector<float> expected = ascending(5000);
  expected[4096] = -1;
  EXPECT_EQ(second, [&] {
    auto v = expected;
    v[4999] = -4;
    return CopyOnWriteFloats(v);
  }());
  EXPECT_EQ(third, [&] {
    auto v = expected;
    v[4999] = -3;
    return CopyOnWriteFloats(v);
  }());
  EXPECT_EQ(first, [&] {
    auto v = expected;
    v[0] = -2;
    return CopyOnWriteFloats(v);
  }());
  second = first;
  EXPECT_EQ(second, first);
}

TEST(CopyOnWriteFloats, ACopyOutlivesWhatItWasCopiedFrom) {
  CopyOnWriteFloats copy;
  {
    CopyOnWriteFloats first(ascending(3000));
    first.set(7, 70);
    copy = first;
  }
  EXPECT_EQ(copy[7], 70);
  EXPECT_EQ(copy[2999], 2999);
}

TEST(CopyOnWriteFloats, PreparingChangesNothingAndSharesNothingWritten) {
  CopyOnWriteFloats first(ascending(20'000));
  const CopyOnWriteFloats before = first;
  std::thread other([&] { first.prepare(0, 19'999); });
  for (std::size_t n = 0; n < 20'000; n += 3) first.set(n, -1);
  other.join();
  for (std::size_t n = 0; n < 20'000; ++n) {
    ASSERT_EQ(first[n], n % 3 == 0 ? -1.0f : static_cast<float>(n));
    ASSERT_EQ(before[n], static_cast<float>(n));
  }
}

// 40 MB; what the allocator itself keeps is well below a tenth of it.
TEST(CopyOnWriteFloats, CopiesTakeTheMemoryOfWhatWasWritten) {
  const CopyOnWriteFloats first(ascending(kCount));
  const double before_MiB = own_memory_MiB();
  std::vector<CopyOnWriteFloats> copies(10, first);
  for (CopyOnWriteFloats& copy : copies) {
    for (std::size_t n = 0; n < kCount / 100; ++n) copy.set(n, -1);
    EXPECT_EQ(std::accumulate(copy.begin() + kCount / 100, copy.begin() + kCount / 50, 0.0),
              std::accumulate(first.begin() + kCount / 100, first.begin() + kCount / 50, 0.0));
  }
  EXPECT_LT(own_memory_MiB() - before_MiB, 8);
}

}  // namespace
}  // namespace osteomill
