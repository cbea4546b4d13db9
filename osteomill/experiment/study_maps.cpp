#include "osteomill/experiment/study_maps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/numbers/distribution.h"

namespace osteomill {

namespace {

constexpr std::size_t kMaxCells = 40, kParts = 24, kMaxTics = 8;
constexpr double kMuch = 10;

std::string label_of(const StudyDesign& design, const std::string& name) {
  for (const StudyColumn& column : columns_of(design.test))
    if (column.name == name) return column.label;
  const std::string* unit = find_value(design.units, name);
  return unit == nullptr || unit->empty() ? name : fmt::format("{} ({})", name, *unit);
}

// A unit that both have is none of their ratio.
std::string ratio_label(std::string above, std::string below) {
  const auto unit_of = [](const std::string& label) {
    return label.ends_with(')') ? label.substr(label.rfind(" (")) : std::string();
  };
  if (const std::string unit = unit_of(above); !unit.empty() && unit == unit_of(below)) {
    above.resize(above.size() - unit.size());
    below.resize(below.size() - unit.size());
  }
  return above + " / " + (below.find('/') == std::string::npos ? below : "(" + below + ")");
}

// The cells of an axis: values, or parts of their range, by their edges.
struct Cells {
  std::vector<double> edges;
  std::vector<double> tics;
  bool logarithmic = false;

  std::size_t count() const { return edges.size() - 1; }
  // Of the axis's length.
  double share_at(double value) const {
    const double from = edges.front(), to = edges.back();
    return logarithmic ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
  }
  std::size_t of(double value) const {
    const auto above = std::upper_bound(edges.begin(), edges.end(), value);
    const auto n = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, above - edges.begin()));
    return std::min(n, count()) - 1;
  }
};

double between(double a, double b, bool logarithmic) {
  return logarithmic ? std::sqrt(a * b) : 0.5 * (a + b);
}

// Beyond the last by as much as the edge before lies ahead of it.
double mirrored(double value, double edge, bool logarithmic) {
  return logarithmic ? value * value / edge : 2 * value - edge;
}

Cells cells_of(const std::set<double>& values, bool words) {
  Cells cells;
  const double min = *values.begin(), max = *values.rbegin();
  cells.logarithmic = !words && min > 0 && max / min >= kMuch;
  if (values.size() > kMaxCells) {
    const StudyRange range{min, max, cells.logarithmic};
    cells.edges = steps_of(range, kParts + 1);
    return cells;
  }
  if (values.size() == 1) {
    const double half = words || min == 0 ? 0.5 : 0.1 * std::abs(min);
    cells.edges = {min - half, min + half};
  } else {
    for (auto next = std::next(values.begin()); next != values.end(); ++next)
      cells.edges.push_back(between(*std::prev(next), *next, cells.logarithmic));
    cells.edges.insert(cells.edges.begin(), mirrored(min, cells.edges.front(), cells.logarithmic));
    cells.edges.push_back(mirrored(max, cells.edges.back(), cells.logarithmic));
  }
  if (words || values.size() <= kMaxTics) cells.tics.assign(values.begin(), values.end());
  return cells;
}

std::string axis_script(char axis, const Cells& cells, const ShownQuantity& shown) {
  std::string script =
      fmt::format("{0} logscale {1}\nset {1}range [{2:.9g}:{3:.9g}]\nset {1}label {4} noenhanced\n",
                  cells.logarithmic ? "set" : "unset", axis, cells.edges.front(), cells.edges.back(),
                  gnuplot_quoted(shown.label()));
  if (cells.tics.empty()) return script + fmt::format("set {}tics autofreq\n", axis);
  std::string tics;
  double last = -1;
  for (std::size_t n = 0; n < cells.tics.size(); ++n) {
    const bool is_word = !shown.words().empty();
    const double share = cells.share_at(cells.tics[n]);
    // Numbers beside each other need room.
    if (axis == 'x' && !is_word && n > 0 && share - last < 0.15) continue;
    last = share;
    tics += fmt::format("{}{} {:.9g}", n == 0 ? "" : ", ",
                        gnuplot_quoted(is_word ? shown.words()[n] : fmt::format("{:.4g}", cells.tics[n])),
                        cells.tics[n]);
  }
  return script + fmt::format("set {}tics ({})\n", axis, tics);
}

double statistic_of(const std::string& statistic, const std::vector<double>& values) {
  if (statistic == "max") return *std::max_element(values.begin(), values.end());
  if (statistic == "median") return percentile(values, 0.5);
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::string colour_script(const StudyMap& map, const std::string& label, double min, double max,
                          const PanelGrid& grid) {
  const bool logarithmic = map.logarithmic_colour && min > 0;
  if (!(max > min)) max = min + (min == 0 ? 1 : 0.1 * std::abs(min));
  const auto up = [&](double px) { return 1 - px / grid.height_px; };
  std::string tics;
  for (const double value : steps_of({min, max, true}, logarithmic ? 5 : 1))
    tics += fmt::format("{}'{:.3g}' {:.6g}", tics.empty() ? "" : ", ", value, value);
  return fmt::format(
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n"
      "{} logscale cb\nset cbtics {}\nset cbrange [{:.6g}:{:.6g}]\nset format cb '%g'\nset format x "
      "'%g'\nset format y "
      "'%g'\n"
      "set label 101 {} at screen 0.5,screen {:.4f} center font ',15' noenhanced\n"
      "set label 102 {} at screen 0.5,screen {:.4f} center noenhanced\n"
      "set colorbox horizontal user origin screen 0.3,screen {:.4f} size screen 0.4,screen {:.4f} border\n",
      logarithmic ? "set" : "unset", logarithmic ? "(" + tics + ")" : "autofreq", min, max,
      gnuplot_quoted(map.title), up(22),
      gnuplot_quoted(fmt::format("{}: {} of a cell", label, map.statistic)), up(50), up(78),
      14 / grid.height_px);
}

}  // namespace

ShownQuantity::ShownQuantity(const StudyDesign& design, const std::string& shown) {
  const std::vector<StudyColumn>& columns = columns_of(design.test);
  std::vector<std::string> labels;
  for (const std::string& name : names_in(shown)) {
    const auto column = std::find_if(columns.begin(), columns.end(),
                                     [&](const StudyColumn& one) { return one.name == name; });
    if (column == columns.end()) {
      sources_.emplace_back(name);
    } else {
      sources_.emplace_back(static_cast<std::size_t>(column - columns.begin()));
    }
    labels.push_back(label_of(design, name));
  }
  label_ = labels.size() == 1 ? labels.front() : ratio_label(labels.front(), labels.back());
}

double ShownQuantity::of(const std::variant<std::size_t, std::string>& source, const StudySettings& settings,
                         const TrialRow& row) {
  if (const auto* column = std::get_if<std::size_t>(&source)) return row.values[*column];
  const std::string* text = find_value(settings, std::get<std::string>(source));
  if (text == nullptr) return kNotMeasured;
  double number = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), number);
  if (error == std::errc() && end == text->data() + text->size()) return number;
  const auto known = std::find(words_.begin(), words_.end(), *text);
  const auto place = static_cast<double>(known - words_.begin());
  if (known == words_.end()) words_.push_back(*text);
  return place;
}

double ShownQuantity::of(const StudySettings& settings, const TrialRow& row) {
  const double value = of(sources_.front(), settings, row);
  return sources_.size() == 1 ? value : value / of(sources_.back(), settings, row);
}

MapOfStudy::MapOfStudy(const StudyDesign& design, const StudyMap& map)
    : map_(map), x_(design, map.x), y_(design, map.y), colour_(design, map.colour) {
  const auto parts = parts_of(design.test);
  const auto part = std::find(parts.begin(), parts.end(), map.part);
  if (part != parts.end()) part_ = static_cast<std::size_t>(part - parts.begin());
}

std::size_t MapOfStudy::panel_of(const StudySettings& settings) {
  std::string name;
  for (const std::string& key : names_in(map_.panels))
    if (const std::string* value = find_value(settings, key)) name += (name.empty() ? "" : ", ") + *value;
  const auto known = std::find(panels_.begin(), panels_.end(), name);
  if (known != panels_.end()) return static_cast<std::size_t>(known - panels_.begin());
  panels_.push_back(name);
  return panels_.size() - 1;
}

void MapOfStudy::add(const StudySettings& settings, const TrialRow& row) {
  if (row.part != part_) return;
  const Point point{panel_of(settings), x_.of(settings, row), y_.of(settings, row),
                    colour_.of(settings, row)};
  if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.colour))
    points_.push_back(point);
}

std::string MapOfStudy::caption() const {
  return fmt::format(
      "{}: {} of the trials in a cell, by {} and {}. What is white was not tried, or could not be "
      "measured.",
      colour_.label(), map_.statistic, x_.label(), y_.label());
}

Figure MapOfStudy::draw(const std::string& name, const std::filesystem::path& folder) const {
  const TemporaryFolder work;
  std::set<double> xs, ys;
  for (const Point& point : points_) {
    xs.insert(point.x);
    ys.insert(point.y);
  }
  const Cells x = cells_of(xs, !x_.words().empty()), y = cells_of(ys, !y_.words().empty());
  const std::size_t panels = panels_.size();
  std::map<std::array<std::size_t, 3>, std::vector<double>> cells;
  for (const Point& point : points_)
    cells[{point.panel, x.of(point.x), y.of(point.y)}].push_back(point.colour);
  std::vector<std::string> data(panels);
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const auto& [place, values] : cells) {
    const auto [panel, column, row] = place;
    const double value = statistic_of(map_.statistic, values);
    min = std::min(min, value);
    max = std::max(max, value);
    data[panel] += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n",
                               between(x.edges[column], x.edges[column + 1], false),
                               between(y.edges[row], y.edges[row + 1], false), x.edges[column],
                               x.edges[column + 1], y.edges[row], y.edges[row + 1], value);
  }
  PanelGrid grid{.columns = std::min<std::size_t>(panels, 4),
                 .head_px = 118,
                 .left_px = 84,
                 .right_px = 34,
                 .above_px = 34,
                 .below_px = 58};
  grid.rows = (panels + grid.columns - 1) / grid.columns;
  grid.height_px = grid.head_px + 340 * static_cast<double>(grid.rows);
  FigureScript script{name, grid.height_px};
  script.body = begin_panels("") + axis_script('x', x, x_) + axis_script('y', y, y_) +
                colour_script(map_, colour_.label(), min, max, grid);
  for (std::size_t n = 0; n < panels; ++n) {
    if (data[n].empty()) continue;
    const std::string file = fmt::format("map-{}.dat", n);
    write_figure_data(work / file, data[n]);
    script.body += panel_margins(grid, panel_cell(grid, n % grid.columns, n / grid.columns)) +
                   fmt::format("set title {} offset 0,-0.4 noenhanced\n", gnuplot_quoted(panels_[n])) +
                   fmt::format(
                       "plot '{}' using 1:2:3:4:5:6:7 with boxxyerror fs solid noborder lc palette{}\n"
                       "unset label\nunset colorbox\n",
                       file, map_.line_of_equality ? ", x with lines dt 2 lw 2 lc rgb '#d32f2f'" : "");
  }
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
