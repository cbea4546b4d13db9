#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "osteomill/experiment/study_design.h"
#include "osteomill/experiment/trial_rows.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// What a map shows of a trial: an option, a column of its rows, or the ratio of two of them.
class ShownQuantity {
 public:
  ShownQuantity(const StudyDesign& design, const std::string& shown);

  /// Not a number where it is not set or could not be measured. Of an option whose values are no numbers the
  /// place of the value among `words`, to which new ones are added.
  double of(const StudySettings& settings, const TrialRow& row);
  const std::string& label() const { return label_; }
  const std::vector<std::string>& words() const { return words_; }

 private:
  double of(const std::variant<std::size_t, std::string>& source, const StudySettings& settings,
            const TrialRow& row);

  // A column's number, or an option's name.
  std::vector<std::variant<std::size_t, std::string>> sources_;
  std::string label_;
  std::vector<std::string> words_;
};

/// Collects what a map shows from row to row, and draws it.
class MapOfStudy {
 public:
  MapOfStudy(const StudyDesign& design, const StudyMap& map);

  void add(const StudySettings& settings, const TrialRow& row);
  bool empty() const { return points_.empty(); }
  /// A cell for each pair of values, or, of more than 40, for each of 24 equal parts of their range, as SVG
  /// and PNG. Throws as draw_figure does.
  Figure draw(const std::string& name, const std::filesystem::path& folder) const;
  /// What it shows, in words.
  std::string caption() const;

 private:
  struct Point {
    std::size_t panel;
    double x, y, colour;
  };

  std::size_t panel_of(const StudySettings& settings);

  StudyMap map_;
  std::size_t part_ = 0;
  ShownQuantity x_, y_, colour_;
  std::vector<std::string> panels_;
  std::vector<Point> points_;
};

}  // namespace osteomill
