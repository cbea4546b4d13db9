#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/tick_record.h"

namespace osteomill::testing_support {

/// A folder for the running test, empty at its start and deleted at its end.
class TestFolder {
 public:
  TestFolder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()) /
            (std::string("osteomill_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline RunDescription sample_description() {
  RunDescription d;
  d.program_version = "0.1.0";
  d.scan_name = "Zahn \xc3\xbc 7 (é)";
  d.dims = {256, 255, 176};
  d.spacing_mm = {0.1, 0.2, 1.0 / 3.0};
  d.isovalue = 1234.5;
  d.tool = {1.25, 0.75, 24};
  d.algorithm = algorithm_named("point-shell").id;
  d.phase = "holding";
  d.seed = 0xfedcba9876543210u;
  d.tick_period_s = 0.001;
  d.settings = {{"stiffness", 2.5, "N/mm"},
                {"zeta", std::string("last in the alphabet, second here"), ""},
                {"command_line", std::string("osteomill compare --out x"), ""},
                {"empty", std::string(), ""},
                {"hand_mass", 0.1, "kg"}};
  for (int n = 0; n < 40; ++n)
    d.settings.push_back({"setting_" + std::to_string(97 - n), 1.0 / (n + 1), "mm"});
  return d;
}

/// Returns a record in which all numbers differ from each other and depend on `tick` in their last bits.
inline TickRecord sample_record(int tick) {
  TickRecord record;
  double number = 0.1 + tick;
  for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
    number = std::nextafter(number * 1.0000123, 1e300) + 0.7;
    if (!column.range.whole) column.set(record, tick % 2 == 0 ? number : -1.0 / number);
  }
  record.time_s = tick * 0.001;
  record.contacts = tick % 300000;
  record.fault = static_cast<WrenchFault>(tick % 10);
  record.spindle_on = tick % 3 == 0;
  record.driven = tick % 4 != 0;
  return record;
}

/// Returns whether all columns agree bit for bit.
inline bool same_bits(const TickRecord& a, const TickRecord& b) {
  for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
    const double left = column.get(a);
    const double right = column.get(b);
    if (std::memcmp(&left, &right, sizeof left) != 0) return false;
  }
  return true;
}

}  // namespace osteomill::testing_support
