#include "picture_stack.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/volume/label_map.h"

#include "header_text.h"
#include "picture_files.h"
#include "plausible_scan.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

// Natural order: slice 2 comes before slice 10.
bool comes_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    const auto digits = [](std::string_view text) {
      return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_digit) - text.begin());
    };
    std::size_t of_a = digits(a), of_b = digits(b);
    if (of_a == 0 || of_b == 0) {
      if (a.front() != b.front()) return a.front() < b.front();
      of_a = of_b = 1;
    } else {
      const auto number = [](std::string_view text) {
        return text.substr(std::min(text.find_first_not_of('0'), text.size()));
      };
      const std::string_view x = number(a.substr(0, of_a)), y = number(b.substr(0, of_b));
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    }
    a.remove_prefix(of_a);
    b.remove_prefix(of_b);
  }
  return a.size() < b.size();
}

// Texts of a name and the numbers between them.
struct NameParts {
  std::vector<std::string> texts;
  std::vector<double> numbers;
};

NameParts parts_of(const fs::path& path) {
  const std::string name = lower(path.stem().string());
  NameParts parts{{""}, {}};
  for (auto letter = name.begin(); letter != name.end();) {
    const auto end = std::find_if_not(letter, name.end(), is_digit);
    if (end == letter) {
      parts.texts.back() += *letter++;
      continue;
    }
    parts.numbers.push_back(parse_number<double>(std::string(letter, end)).value_or(0));
    parts.texts.emplace_back();
    letter = end;
  }
  return parts;
}

// Returns the number of each picture: the only number in the names that differs. Empty if several differ or
// none.
std::vector<double> slice_numbers(const std::vector<NameParts>& names) {
  std::vector<double> numbers;
  for (std::size_t n = 0; n < names.front().numbers.size(); ++n) {
    const auto is_usual = [&](const NameParts& name) { return name.numbers[n] == names.front().numbers[n]; };
    if (std::all_of(names.begin(), names.end(), is_usual)) continue;
    if (!numbers.empty()) return {};
    for (const NameParts& name : names) numbers.push_back(name.numbers[n]);
  }
  return numbers;
}

// Checks by the names, in order, that the pictures form one complete stack; pictures contain no other
// information on it.
void check_names(const std::string& subject, const std::vector<fs::path>& files,
                 std::vector<std::string>& warnings) {
  std::vector<NameParts> names;
  for (const fs::path& file : files) {
    names.push_back(parts_of(file));
    if (names.back().texts != names.front().texts) {
      throw InputError(subject, fmt::format("holds pictures of several stacks, whose names differ in more "
                                            "than numbers: {} and {}; use a folder for each stack",
                                            files.front().filename().string(), file.filename().string()));
    }
  }
  const std::vector<double> numbers = slice_numbers(names);
  std::vector<double> steps;
  for (std::size_t n = 1; n < numbers.size(); ++n) steps.push_back(numbers[n] - numbers[n - 1]);
  if (steps.empty()) return;
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const auto odd = std::find_if(steps.begin(), steps.end(), [&](double step) { return step != usual; });
  if (odd == steps.end()) return;
  const auto n = static_cast<std::size_t>(odd - steps.begin());
  const std::string here =
      fmt::format("{} follows {}", files[n + 1].filename().string(), files[n].filename().string());
  if (sorted.front() < usual) {
    warnings.push_back(
        fmt::format("has pictures whose numbers grow unevenly ({}): even distances were assumed", here));
    return;
  }
  throw InputError(subject,
                   fmt::format("a slice is missing: {}, and numbers grow by {} otherwise", here, usual));
}

bool is_png(const fs::path& path) {
  return lower(path.extension().string()) == ".png";
}

// Collects the slices. Pixels of pictures with at least three channels become a colour value, red * 65536 +
// green * 256 + blue; 0 if fully transparent.
class Slices {
 public:
  explicit Slices(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  void add(const std::string& subject, const Picture& picture) {
    if (count_++ == 0) {
      first_ = {picture.columns, picture.rows, picture.channels, picture.bits};
    } else if (picture.columns != first_.columns || picture.rows != first_.rows ||
               picture.channels != first_.channels || picture.bits != first_.bits) {
      throw InputError(
          subject, fmt::format("is a picture of {} x {} pixels, {} channels and {} bits; the first "
                               "has {} x {} pixels, {} channels and {} bits",
                               picture.columns, picture.rows, picture.channels, picture.bits, first_.columns,
                               first_.rows, first_.channels, first_.bits));
    }
    check_memory(subject, count_ * picture.columns * picture.rows, max_bytes_);
    for (std::size_t at = 0; at < picture.values.size(); at += picture.channels)
      densities_.push_back(picture.channels < 3 ? picture.values[at] : colour_at(subject, picture, at));
  }

  std::size_t count() const { return count_; }
  const Picture& first() const { return first_; }
  bool are_coloured() const { return coloured_; }

  std::vector<float> take(const std::string& subject) {
    if (first_.channels < 3 || first_.bits > 8) return std::move(densities_);
    std::map<float, float> labels{{0, 0}};
    for (float& value : densities_) {
      if (!coloured_) {
        value = std::fmod(value, 256.0F);
        continue;
      }
      value = labels.emplace(value, static_cast<float>(labels.size())).first->second;
      if (labels.size() > LabelMap::kMaxLabels + 1) {
        throw InputError(
            subject, fmt::format("holds over {} colours; scans are grey, and label maps have fewer colours",
                                 LabelMap::kMaxLabels));
      }
    }
    return std::move(densities_);
  }

 private:
  float colour_at(const std::string& subject, const Picture& picture, std::size_t at) {
    const float red = picture.values[at], green = picture.values[at + 1], blue = picture.values[at + 2];
    const bool is_grey = red == green && green == blue;
    if (picture.bits > 8) {
      if (!is_grey) throw InputError(subject, "is a colour picture with more than 8 bits per channel");
      return red;
    }
    if (picture.channels == 4 && picture.values[at + 3] == 0) return 0;
    coloured_ = coloured_ || !is_grey;
    return red * 65536 + green * 256 + blue;
  }

  std::uint64_t max_bytes_;
  std::size_t count_ = 0;
  Picture first_{};
  bool coloured_ = false;
  std::vector<float> densities_;
};

}  // namespace

bool is_picture(const fs::path& path) {
  const std::string ending = lower(path.extension().string());
  return ending == ".png" || ending == ".tif" || ending == ".tiff";
}

Scan read_pictures(const fs::path& path, std::vector<fs::path> files, const ReadOptions& options) {
  const std::string subject = path.string();
  if (!options.spacing_mm)
    throw InputError(subject, "has pictures, which contain no voxel spacing; give it with --spacing");
  if (std::any_of(files.begin(), files.end(), [&](const fs::path& file) {
        return file.parent_path() != files.front().parent_path() || is_png(file) != is_png(files.front());
      }))
    throw InputError(
        subject, "holds pictures in several folders, or both PNG and TIFF; choose a folder with one kind");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  std::vector<std::string> warnings;
  check_names(subject, files, warnings);
  Slices slices(options.max_memory_bytes);
  {
    const WorkProgress::Part reading(0.85);
    for (std::size_t n = 0; n < files.size(); ++n) {
      const auto add = [&](const Picture& picture) { slices.add(files[n].string(), picture); };
      (is_png(files[n]) ? read_png : read_tiff)(files[n], options.max_memory_bytes, add);
      WorkProgress::done(n + 1, files.size());
    }
  }
  const WorkProgress::Part checking(1);
  if (slices.count() < 2) throw InputError(subject, "is a single picture; choose the folder with all slices");
  GridGeometry geometry;
  geometry.dims = {static_cast<int>(slices.first().columns), static_cast<int>(slices.first().rows),
                   static_cast<int>(slices.count())};
  geometry.spacing_mm = *options.spacing_mm;
  check_plausible(subject, geometry);
  std::vector<float> densities = slices.take(subject);
  check_densities(subject, densities);
  warnings.push_back(
      "does not state its orientation in the patient; its columns, rows and slices were assumed to run along "
      "L, P and S");
  Scan scan{DensityGrid(geometry, std::move(densities)), subject, is_png(files.front()) ? "PNG" : "TIFF",
            std::move(warnings)};
  if (slices.are_coloured()) {
    scan.is_labels = true;
    scan.warnings.push_back("is in colour; each colour was read as a label");
  }
  return scan;
}

}  // namespace osteomill
