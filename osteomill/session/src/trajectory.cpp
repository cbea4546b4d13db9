#include "osteomill/session/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/read_line.h"

namespace osteomill {

namespace {

constexpr std::array<std::string_view, 9> kColumns{"time_s", "x_mm", "y_mm", "z_mm",   "qw",
                                                   "qx",     "qy",   "qz",   "milling"};
constexpr double kUnitTolerance = 1e-3;
// A longer line is most likely from a binary file.
constexpr std::size_t kMaxLine = 4096;

using Row = std::array<double, kColumns.size()>;

class TrajectoryReader {
 public:
  explicit TrajectoryReader(const std::filesystem::path& path) : name_(path.string()), file_(path) {
    if (!std::filesystem::exists(path)) throw InputError(name_, "no such file");
    if (!file_ || std::filesystem::is_directory(path)) throw InputError(name_, "cannot be read");
    register_input(path);
  }

  std::vector<TrajectoryPoint> read() {
    read_head();
    std::vector<TrajectoryPoint> points;
    while (next_line()) {
      if (line_.empty() || line_ == "\r") continue;
      const TrajectoryPoint point = point_of(row());
      if (!points.empty() && point.time_s <= points.back().time_s) {
        fail(fmt::format("time_s {} does not go forward from {}", point.time_s, points.back().time_s));
      }
      points.push_back(point);
    }
    if (points.empty()) throw InputError(name_, "has no rows");
    return points;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(name_, fmt::format("row {}: {}", row_number_, reason));
  }

  bool next_line() {
    ++row_number_;
    try {
      if (!read_line(file_, line_, kMaxLine)) return false;
    } catch (const LineTooLong&) {
      fail("too long for a row of a trajectory");
    }
    // Spreadsheets write a byte order mark before the first line.
    if (row_number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.erase(0, 3);
    return true;
  }

  void read_head() {
    if (!next_line()) throw InputError(name_, "is empty");
    const auto names = csv_fields(line_);
    for (std::size_t n = 0; n < kColumns.size(); ++n) {
      const auto found = std::find(names.begin(), names.end(), kColumns[n]);
      if (found == names.end()) fail(fmt::format("the column {} is missing", kColumns[n]));
      field_of_column_[n] = static_cast<std::size_t>(found - names.begin());
    }
    fields_ = names.size();
  }

  Row row() const {
    const auto fields = csv_fields(line_);
    if (fields.size() != fields_) fail(fmt::format("{} values for {} columns", fields.size(), fields_));
    Row row;
    for (std::size_t n = 0; n < kColumns.size(); ++n) {
      const std::string_view text = fields[field_of_column_[n]];
      const auto value = parse_finite(text);
      if (!value) fail(fmt::format("{} is not a number: '{}'", kColumns[n], text));
      row[n] = *value;
    }
    return row;
  }

  TrajectoryPoint point_of(const Row& row) const {
    TrajectoryPoint point;
    point.time_s = row[0];
    point.X_WD.position_mm = {row[1], row[2], row[3]};
    if (!is_reachable(point.X_WD))
      fail(fmt::format("x_mm,y_mm,z_mm is farther than {:g} mm from the origin", kMaxPose_mm));
    const Quat orientation(row[4], row[5], row[6], row[7]);
    if (!(std::abs(orientation.norm() - 1.0) <= kUnitTolerance)) {
      fail(fmt::format("qw,qx,qy,qz is not a unit quaternion (its length is {:.6g})", orientation.norm()));
    }
    point.X_WD.orientation = orientation.normalized();
    if (row[8] != 0.0 && row[8] != 1.0) fail("milling is neither 0 nor 1");
    point.milling = row[8] == 1.0;
    return point;
  }

  std::string name_;
  std::ifstream file_;
  std::string line_;
  int row_number_ = 0;
  std::size_t fields_ = 0;
  std::array<std::size_t, kColumns.size()> field_of_column_{};
};

}  // namespace

std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path) {
  return TrajectoryReader(path).read();
}

}  // namespace osteomill
