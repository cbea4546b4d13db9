#include <cstdlib>
#include <fstream>
#include <locale>
#include <sstream>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/record_columns.h"

#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

using namespace testing_support;

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

constexpr const char* kHeader =
    "time_s,device_x_mm,device_y_mm,device_z_mm,device_qw,device_qx,device_qy,device_qz,"
    "tool_x_mm,tool_y_mm,tool_z_mm,tool_qw,tool_qx,tool_qy,tool_qz,"
    "force_x_N,force_y_N,force_z_N,torque_x_Nmm,torque_y_Nmm,torque_z_Nmm,contacts,removed_mm3,compute_us,"
    "energy_given_Nmm,spindle_rpm,cutting_power_W";

TEST(WriteCsv, WritesLogColumnsInOrder) {
  const TestFolder folder;
  TickRecord record;
  record.time_s = 1;
  record.X_WD = {{2, 3, 4}, Quat(5, 6, 7, 8)};
  record.X_WT = {{9, 10, 11}, Quat(12, 13, 14, 15)};
  record.wrench = {{16, 17, 18.5}, {19, 20, -21}};
  record.contacts = 22;
  record.removed_mm3 = 23;
  record.compute_us = 24;
  record.energy_given_Nmm = 25;
  record.spindle_rpm = 26;
  record.cutting_power_W = 27;
  write_csv(folder / "log.csv", std::vector{record});
  const auto lines = lines_of(folder / "log.csv");
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], kHeader);
  EXPECT_EQ(lines[1], "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18.5,19,20,-21,22,23,24,25,26,27");
}

TEST(WriteCsv, NumbersReadBackExactly) {
  const TestFolder folder;
  std::vector<TickRecord> records;
  for (int tick = 0; tick < 200; ++tick) records.push_back(sample_record(tick));
  write_csv(folder / "log.csv", records);
  const auto lines = lines_of(folder / "log.csv");
  ASSERT_EQ(lines.size(), records.size() + 1);
  for (std::size_t row = 0; row < records.size(); ++row) {
    std::istringstream fields(lines[row + 1]);
    for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
      if (!column.has(kInLog)) continue;
      std::string field;
      ASSERT_TRUE(std::getline(fields, field, ','));
      EXPECT_EQ(std::strtod(field.c_str(), nullptr), column.get(records[row])) << column.name;
    }
  }
}

class CommaForPoint : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(WriteCsv, WritesDecimalPointsInAnyLocale) {
  const TestFolder folder;
  TickRecord record;
  record.time_s = 0.5;
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaForPoint));
  write_csv(folder / "log.csv", std::vector{record});
  std::locale::global(before);
  EXPECT_TRUE(lines_of(folder / "log.csv").at(1).starts_with("0.5,"));
}

TEST(WriteCsv, AFolderThatIsMissingIsNamed) {
  const TestFolder folder;
  EXPECT_THROW(write_csv(folder / "none/log.csv", {}), InputError);
}

}  // namespace
}  // namespace osteomill
