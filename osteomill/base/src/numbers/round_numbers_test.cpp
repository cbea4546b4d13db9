#include "osteomill/base/round_numbers.h"

#include <array>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(RoundNumbers, AreOneTwoOrFiveTimesAPowerOfTen) {
  for (const auto& [value, below, above] : {std::array{0.3, 0.2, 0.5}, std::array{4.9, 2.0, 5.0},
                                            std::array{73.0, 50.0, 100.0}, std::array{1.5e-4, 1e-4, 2e-4}}) {
    EXPECT_DOUBLE_EQ(round_down(value), below) << value;
    EXPECT_DOUBLE_EQ(round_up(value), above) << value;
  }
}

TEST(RoundNumbers, StayUnchangedIfAlreadyRound) {
  for (const double value : {0.02, 0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 500.0}) {
    EXPECT_DOUBLE_EQ(round_down(value), value);
    EXPECT_DOUBLE_EQ(round_up(value), value);
  }
}

}  // namespace
}  // namespace osteomill
