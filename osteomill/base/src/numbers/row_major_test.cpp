#include "osteomill/base/row_major.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(RowMajor, MapsCellsToConsecutiveIndicesAndBack) {
  const std::array<int, 3> dims{3, 5, 4};
  std::size_t index = 0;
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i, ++index) {
        EXPECT_EQ(row_major(dims, i, j, k), index);
        EXPECT_EQ(cell_at(dims, index), (std::array<int, 3>{i, j, k}));
      }
    }
  }
  EXPECT_EQ(cell_count(dims), index);
}

// 2048^3 exceeds the range of an int.
TEST(RowMajor, IndexesGridsBeyondTheRangeOfInt) {
  const std::array<int, 3> dims{2048, 2048, 2048};
  EXPECT_EQ(row_major(dims, 2047, 2047, 2047), cell_count(dims) - 1);
  EXPECT_EQ(cell_at(dims, cell_count(dims) - 1), (std::array<int, 3>{2047, 2047, 2047}));
}

}  // namespace
}  // namespace osteomill
