#include "osteomill/session/trajectory.h"

#include <fstream>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

namespace osteomill {
namespace {

constexpr const char* kHead = "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n";

class TrajectoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(::testing::TempDir()) /
            (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".csv");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::vector<TrajectoryPoint> read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_trajectory(path_);
  }
  std::string fault_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find(path_.string() + ": "), 0u);
      return message.substr(path_.string().size() + 2);
    }
    return "none";
  }

  std::filesystem::path path_;
};

TEST_F(TrajectoryTest, ReadsPositionsExactlyAndOrientationsWithinRounding) {
  const auto points = read(fmt::format("{}0,0.1,-2,3e-3,1,0,0,0,0\r\n0.001,1,2,3,0,0.6,0,0.8,1\n\n", kHead));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].X_WD.position_mm, Vec3(0.1, -2, 3e-3));
  EXPECT_FALSE(points[0].milling);
  EXPECT_EQ(points[1].time_s, 0.001);
  EXPECT_TRUE(points[1].milling);
  EXPECT_TRUE(points[1].X_WD.orientation.isApprox(Quat(0, 0.6, 0, 0.8), 1e-15));
}

TEST_F(TrajectoryTest, FindsColumnsByNameInAnyOrder) {
  const auto points = read("milling,note,z_mm,y_mm,x_mm,qz,qy,qx,qw,time_s\n1,hello,3,2,1,0,0,0,1,5\n");
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].X_WD.position_mm, Vec3(1, 2, 3));
  EXPECT_EQ(points[0].time_s, 5);
}

TEST_F(TrajectoryTest, ReportsTheRowOfAPoseFartherThanAnyWorkspace) {
  EXPECT_EQ(read(kHead + std::string("0,300000,-300000,0,1,0,0,0,1\n")).size(), 1u);
  for (const char* far : {"0.001,1e308,10,20,1,0,0,0,1", "0.001,0,-300001,0,1,0,0,0,1"})
    EXPECT_EQ(fault_of(fmt::format("{}0,0,0,0,1,0,0,0,1\n{}\n", kHead, far)),
              "row 3: x_mm,y_mm,z_mm is farther than 300000 mm from the origin");
}

TEST_F(TrajectoryTest, StopsReadingAFileWithoutLineEndsAtTheMaximumRowLength) {
  EXPECT_EQ(fault_of(std::string(5000, '\0')), "row 1: too long for a row of a trajectory");
  // An endless file.
  EXPECT_THROW(read_trajectory("/dev/zero"), InputError);
}

TEST_F(TrajectoryTest, IgnoresAByteOrderMark) {
  EXPECT_EQ(read("\xEF\xBB\xBF" + std::string(kHead) + "0,1,2,3,1,0,0,0,0\n").size(), 1u);
}

TEST_F(TrajectoryTest, ReportsTheRowOfInvalidInput) {
  const std::string head = kHead;
  EXPECT_EQ(fault_of(""), "is empty");
  EXPECT_EQ(fault_of(head), "has no rows");
  EXPECT_EQ(fault_of("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n"),
            "row 1: the column milling is missing");
  EXPECT_EQ(fault_of(head + "0,0,0,0,1,0,0,0,0\n1,0,zero,0,1,0,0,0,0\n"),
            "row 3: y_mm is not a number: 'zero'");
  EXPECT_EQ(fault_of(head + "0,nan,0,0,1,0,0,0,0\n"), "row 2: x_mm is not a number: 'nan'");
  EXPECT_EQ(fault_of(head + "0,1e999,0,0,1,0,0,0,0\n"), "row 2: x_mm is not a number: '1e999'");
  EXPECT_EQ(fault_of(head + "0,0,0,0,1,1,0,0,0\n"),
            "row 2: qw,qx,qy,qz is not a unit quaternion (its length is 1.41421)");
  EXPECT_EQ(fault_of(head + "0,0,0,0,1,0,0,0,0\n0,0,0,0,1,0,0,0,0\n"),
            "row 3: time_s 0 does not go forward from 0");
  EXPECT_EQ(fault_of(head + "0,0,0,0,1,0,0,0,2\n"), "row 2: milling is neither 0 nor 1");
  EXPECT_EQ(fault_of(head + "0,0,0,0,1\n"), "row 2: 5 values for 9 columns");
  EXPECT_EQ(fault_of(head + std::string(10000, '0')), "row 2: too long for a row of a trajectory");
}

TEST_F(TrajectoryTest, RefusesAMissingFile) {
  EXPECT_THROW(read_trajectory(path_ / "none.csv"), InputError);
}

}  // namespace
}  // namespace osteomill
