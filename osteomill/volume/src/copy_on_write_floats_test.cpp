#include "osteomill/volume/copy_on_write_floats.h"

#include <cstddef>
#include <numeric>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/own_memory.h"

namespace osteomill {
namespace {

using testing_support::own_memory_MiB;

constexpr std::size_t kCount = 10'000'000;

std::vector<float> ascending(std::size_t count) {
  std::vector<float> values(count);
  std::iota(values.begin(), values.end(), 0.0f);
  return values;
}

CopyOnWriteFloats dense(std::vector<float> values) {
  const RowLayout layout = RowLayout::with_padding(values.size(), 1, 1);
  return CopyOnWriteFloats(std::move(values), layout);
}

TEST(CopyOnWriteFloats, HoldsTheGivenValues) {
  for (const std::size_t count : {1, 15, 1023, 1024, 1025, 5'000'000}) {
    const std::vector<float> values = ascending(count);
    const CopyOnWriteFloats floats = dense(values);
    EXPECT_TRUE(std::equal(values.begin(), values.end(), floats.data())) << count;
  }
  EXPECT_TRUE(CopyOnWriteFloats({}, RowLayout::with_padding(0, 1, 1)).empty());
}

TEST(RowLayout, SpreadsNeighbouringRowsOverCacheSets) {
  constexpr std::size_t kLine = 16, kSets = 64;
  for (const std::size_t width : {64u, 65u, 100u, 192u, 256u, 511u, 512u, 1024u}) {
    const RowLayout layout = RowLayout::with_padding(width, width, 20);
    EXPECT_GE(layout.row_stride, width);
    EXPECT_LE(layout.row_stride, width + 2 * kLine);
    EXPECT_GE(layout.slice_stride, width * layout.row_stride);
    EXPECT_LT(layout.slice_stride, width * layout.row_stride + kSets * kLine);
    EXPECT_LT(layout.size(), 1.6 * static_cast<double>(width * width * 20));
    std::multiset<std::size_t> sets;
    for (std::size_t k = 0; k < 12; ++k) {
      for (std::size_t j = 0; j < 12; ++j) {
        const std::size_t at = j * layout.row_stride + k * layout.slice_stride;
        EXPECT_EQ(at % kLine, 0u);
        sets.insert(at / kLine % kSets);
      }
    }
    for (const std::size_t set : sets) EXPECT_LE(sets.count(set), 3u) << width;
  }
}

TEST(RowLayout, HasNoPaddingForThinScans) {
  EXPECT_EQ(RowLayout::with_padding(2, 2, 10'000'000).size(), 40'000'000u);
  EXPECT_EQ(RowLayout::with_padding(512, 8, 512).size(), 512u * 8 * 512);
}

TEST(CopyOnWriteFloats, PadsRowsWithZeros) {
  const std::vector<float> values = ascending(2 * 70 * 100);
  const RowLayout layout = RowLayout::with_padding(100, 70, 2);
  const CopyOnWriteFloats floats(values, layout);
  std::vector<float> expected(layout.size());
  for (std::size_t row = 0; row < 2 * 70; ++row) {
    const std::size_t at = row / 70 * layout.slice_stride + row % 70 * layout.row_stride;
    for (std::size_t i = 0; i < 100; ++i) expected[at + i] = values[100 * row + i];
  }
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), floats.data(), floats.data() + floats.size()));
}

TEST(CopyOnWriteFloats, CopiesDifferOnlyInWrittenValues) {
  CopyOnWriteFloats first = dense(ascending(5000));
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
    return dense(v);
  }());
  EXPECT_EQ(third, [&] {
    auto v = expected;
    v[4999] = -3;
    return dense(v);
  }());
  EXPECT_EQ(first, [&] {
    auto v = expected;
    v[0] = -2;
    return dense(v);
  }());
  second = first;
  EXPECT_EQ(second, first);
}

TEST(CopyOnWriteFloats, CopyOutlivesItsSource) {
  CopyOnWriteFloats copy;
  {
    CopyOnWriteFloats first = dense(ascending(3000));
    first.set(7, 70);
    copy = first;
  }
  EXPECT_EQ(copy[7], 70);
  EXPECT_EQ(copy[2999], 2999);
}

TEST(CopyOnWriteFloats, PrefaultDuringWritesKeepsValuesOfBothCopies) {
  CopyOnWriteFloats first = dense(ascending(20'000));
  const CopyOnWriteFloats before = first;
  std::thread other([&] { first.prefault(0, 19'999); });
  for (std::size_t n = 0; n < 20'000; n += 3) first.set(n, -1);
  other.join();
  for (std::size_t n = 0; n < 20'000; ++n) {
    ASSERT_EQ(first[n], n % 3 == 0 ? -1.0f : static_cast<float>(n));
    ASSERT_EQ(before[n], static_cast<float>(n));
  }
}

// 40 MB; the allocator's own overhead is well below a tenth of that.
TEST(CopyOnWriteFloats, CopiesTakeMemoryOnlyForWrittenValues) {
  const CopyOnWriteFloats first = dense(ascending(kCount));
  const double before_MiB = own_memory_MiB();
  std::vector<CopyOnWriteFloats> copies(10, first);
  for (CopyOnWriteFloats& copy : copies) {
    for (std::size_t n = 0; n < kCount / 100; ++n) copy.set(n, -1);
    EXPECT_EQ(std::accumulate(copy.data() + kCount / 100, copy.data() + kCount / 50, 0.0),
              std::accumulate(first.data() + kCount / 100, first.data() + kCount / 50, 0.0));
  }
  EXPECT_LT(own_memory_MiB() - before_MiB, 8);
}

}  // namespace
}  // namespace osteomill
