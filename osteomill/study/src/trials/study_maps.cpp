#include "trials/study_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/distribution.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/study/figure.h"

namespace osteomill {

namespace {

constexpr std::size_t kMaxCells = 40, kParts = 24, kMaxTics = 8;
// Axes are logarithmic if their values span at least this factor.
constexpr double kWide = 10;
// Values closer than this relative difference share a position on an axis.
constexpr double kApart = 1e-5;

// Returns whether a scale cannot distinguish two values.
bool is_alike(double a, double b) {
  return std::abs(b - a) <= kApart * std::max(std::abs(a), std::abs(b));
}

// Labels a ratio; a unit that both have cancels.
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

// Returns the index of a text in `known`; appends it if it is new.
std::size_t place_in(std::vector<std::string>& known, const std::string& text) {
  const auto at = std::ranges::find(known, text);
  const auto place = static_cast<std::size_t>(at - known.begin());
  if (at == known.end()) known.push_back(text);
  return place;
}

// Quantity along an axis or as a colour: an option, a column of the rows, or the ratio of two of them.
class MapQuantity {
 public:
  MapQuantity(const StudyDesign& design, const std::string& shown) {
    for (const std::string& name : operands_of(shown)) {
      const auto& columns = columns_of(design.test);
      const Field<TrialRow>* column = find_field(columns, name);
      parts_.push_back({name, column});
      const std::string words_of_it =
          column == nullptr ? design.label_of(name) : osteomill::label_of(*column);
      label = label.empty() ? words_of_it : ratio_label(label, words_of_it);
    }
  }

  // Returns the quantity's value; NaN if it is not set or could not be measured.
  double of(const StudySettings& settings, const TrialRow& row) {
    const double value = one(parts_.front(), settings, row);
    return parts_.size() == 1 ? value : value / one(parts_.back(), settings, row);
  }

  std::string label;
  // Words among an option's values; each is plotted as its index here.
  std::vector<std::string> words;

 private:
  struct Part {
    std::string name;
    // Null if it is an option.
    const Field<TrialRow>* column;
  };
  double one(const Part& part, const StudySettings& settings, const TrialRow& row) {
    if (part.column != nullptr) return part.column->get(row);
    const std::string* text = find_value(settings, part.name);
    if (text == nullptr) return kNotMeasured;
    if (const auto number = parse_number<double>(*text)) return *number;
    return static_cast<double>(place_in(words, *text));
  }

  std::vector<Part> parts_;
};

// Cells of an axis, given by their edges: one per value, or equal parts of the range.
struct Cells {
  std::vector<double> edges;
  std::vector<double> tics;
  bool logarithmic = false;

  std::size_t count() const { return edges.size() - 1; }
  // Returns the position of a value as a fraction of the axis.
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

// Mirrors an edge at the first or last value, to get the edge on its other side.
double mirrored(double value, double edge, bool logarithmic) {
  return logarithmic ? value * value / edge : 2 * value - edge;
}

Cells cells_of(const std::set<double>& values, bool words) {
  Cells cells;
  const double min = *values.begin(), max = *values.rbegin();
  cells.logarithmic = !words && min > 0 && max / min >= kWide;
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

// Returns the width of the tics and label of the y axis, px.
double left_margin_px(const MapQuantity& shown) {
  constexpr double kNumbers_px = 84, kLetter_px = 9, kLabel_px = 64;
  std::size_t longest = 0;
  for (const std::string& word : shown.words) longest = std::max(longest, word.size());
  return std::max(kNumbers_px, kLabel_px + kLetter_px * static_cast<double>(longest));
}

std::string axis_script(char axis, const Cells& cells, const MapQuantity& shown) {
  std::string script =
      fmt::format("{0} logscale {1}\nset {1}range [{2:.9g}:{3:.9g}]\nset {1}label {4} noenhanced\n",
                  cells.logarithmic ? "set" : "unset", axis, cells.edges.front(), cells.edges.back(),
                  gnuplot_quoted(shown.label));
  if (cells.tics.empty()) return script + fmt::format("set {}tics autofreq\n", axis);
  std::string tics;
  double last = -1;
  for (std::size_t n = 0; n < cells.tics.size(); ++n) {
    const bool is_word = !shown.words.empty();
    const double share = cells.share_at(cells.tics[n]);
    // Skips numbers that would overlap.
    if (axis == 'x' && !is_word && n > 0 && share - last < 0.15) continue;
    last = share;
    tics += fmt::format("{}{} {:.9g}", n == 0 ? "" : ", ",
                        gnuplot_quoted(is_word ? shown.words[n] : fmt::format("{:.4g}", cells.tics[n])),
                        cells.tics[n]);
  }
  return script + fmt::format("set {}tics ({})\n", axis, tics);
}

double statistic_of(const std::string& statistic, const std::vector<double>& values) {
  if (statistic != "mean") return percentile(values, statistic == "max" ? 1 : 0.5);
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string colour_script(const StudyMap& map, const std::string& label, double min, double max,
                          const PanelGrid& grid) {
  const bool logarithmic = map.logarithmic_colour && min > 0;
  if (is_alike(min, max)) max = min + (min == 0 ? 1 : 0.1 * std::abs(min));
  const auto up = [&](double px) { return 1 - px / grid.height_px; };
  std::string tics;
  for (const double value : steps_of({min, max, true}, logarithmic ? 5 : 1))
    tics += fmt::format("{}'{:.3g}' {:.6g}", tics.empty() ? "" : ", ", value, value);
  return fmt::format(
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n"
      "{} logscale cb\nset cbtics {}\nset cbrange [{:.6g}:{:.6g}]\nset format cb '%g'\nset format x "
      "'%g'\nset format y '%g'\n"
      "set label 101 {} at screen 0.5,screen {:.4f} center font ',15' noenhanced\n"
      "set label 102 {} at screen 0.5,screen {:.4f} center noenhanced\n"
      "set colorbox horizontal user origin screen 0.3,screen {:.4f} size screen 0.4,screen {:.4f} border\n",
      logarithmic ? "set" : "unset", logarithmic ? "(" + tics + ")" : "autofreq", min, max,
      gnuplot_quoted(map.title), up(22),
      gnuplot_quoted(fmt::format("{}: {} of a cell", label, map.statistic)), up(50), up(78),
      14 / grid.height_px);
}

struct Point {
  std::size_t panel;
  double x, y, colour;
  // True if the trial did not complete this part of its test.
  bool is_unreached;
};

std::string panel_name(const StudyMap& map, const StudySettings& settings) {
  std::string name;
  for (const std::string& key : operands_of(map.panels))
    if (const std::string* value = find_value(settings, key)) name += (name.empty() ? "" : ", ") + *value;
  return name;
}

Cells cells_along(double Point::*axis, const std::vector<Point>& points, const MapQuantity& shown) {
  std::set<double> all, values;
  for (const Point& point : points) all.insert(point.*axis);
  for (const double value : all)
    if (values.empty() || !is_alike(*values.rbegin(), value)) values.insert(value);
  return cells_of(values, !shown.words.empty());
}

struct Gathered {
  MapQuantity x, y, colour;
  std::vector<std::string> panels = {};
  std::vector<Point> points = {};
};

Gathered gather(const StudyDesign& design, const StudyMap& map, const std::vector<TrialRow>& rows) {
  Gathered all{{design, map.x}, {design, map.y}, {design, map.colour}};
  const auto parts = parts_of(design.test);
  for (const TrialRow& row : rows) {
    if (parts[row.part] != (map.part.empty() ? parts.front() : map.part)) continue;
    const StudySettings settings = design.trial(row.trial);
    const Point point{place_in(all.panels, panel_name(map, settings)), all.x.of(settings, row),
                      all.y.of(settings, row), all.colour.of(settings, row), !row.run.not_reached.empty()};
    if (std::isfinite(point.x) && std::isfinite(point.y) &&
        (point.is_unreached || std::isfinite(point.colour)))
      all.points.push_back(point);
  }
  return all;
}

}  // namespace

std::optional<CaptionedFigure> draw_study_map(const StudyDesign& design, const StudyMap& map,
                                              const std::vector<TrialRow>& rows, const std::string& name,
                                              const std::filesystem::path& folder) {
  const auto [shown_x, shown_y, colour, panels, points] = gather(design, map, rows);
  const auto is_measured = [](const Point& point) { return std::isfinite(point.colour); };
  if (std::ranges::none_of(points, is_measured)) return std::nullopt;
  const Cells x = cells_along(&Point::x, points, shown_x), y = cells_along(&Point::y, points, shown_y);
  struct MapCell {
    std::vector<double> values;
    bool has_unreached = false;
  };
  std::map<std::array<std::size_t, 3>, MapCell> cells;
  for (const Point& point : points) {
    MapCell& cell = cells[{point.panel, x.of(point.x), y.of(point.y)}];
    if (is_measured(point)) cell.values.push_back(point.colour);
    cell.has_unreached |= point.is_unreached;
  }
  // Hatching is white over a colour, and grey over none.
  struct Boxes {
    std::string coloured, hatched, hatched_grey;
  };
  std::vector<Boxes> boxes(panels.size());
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const auto& [place, cell] : cells) {
    const auto [panel, column, row] = place;
    const std::string box = fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}",
                                        between(x.edges[column], x.edges[column + 1], false),
                                        between(y.edges[row], y.edges[row + 1], false), x.edges[column],
                                        x.edges[column + 1], y.edges[row], y.edges[row + 1]);
    if (cell.has_unreached)
      (cell.values.empty() ? boxes[panel].hatched_grey : boxes[panel].hatched) += box + "\n";
    if (cell.values.empty()) continue;
    const double value = statistic_of(map.statistic, cell.values);
    min = std::min(min, value);
    max = std::max(max, value);
    boxes[panel].coloured += fmt::format("{} {:.9g}\n", box, value);
  }
  PanelGrid grid{.columns = std::min<std::size_t>(panels.size(), 4),
                 .head_px = 118,
                 .left_px = left_margin_px(shown_y),
                 .right_px = 34,
                 .above_px = 34,
                 .below_px = 58};
  grid.rows = (panels.size() + grid.columns - 1) / grid.columns;
  grid.height_px = grid.head_px + 340 * static_cast<double>(grid.rows);
  const auto panel = [&, &panels = panels](std::size_t column, std::size_t row, FigureScript& figure) {
    const std::size_t n = row * grid.columns + column;
    if (n >= panels.size()) return std::string();
    const auto& [coloured, hatched, hatched_grey] = boxes[n];
    std::vector<std::string> plots;
    if (!coloured.empty())
      plots.push_back(figure.data(coloured) +
                      " using 1:2:3:4:5:6:7 with boxxyerror fs solid noborder lc palette");
    for (const auto& [data, paint] : {std::pair(&hatched, "ffffff"), std::pair(&hatched_grey, "9e9e9e")}) {
      if (data->empty()) continue;
      plots.push_back(
          fmt::format("{} using 1:2:3:4:5:6 with boxxyerror fs transparent pattern 5 noborder lc rgb '#{}'",
                      figure.data(*data), paint));
    }
    if (plots.empty()) return std::string();
    if (map.line_of_equality) plots.emplace_back("x with lines dt 2 lw 2 lc rgb '#d32f2f'");
    return fmt::format("set title {} offset 0,-0.4 noenhanced\nplot {}\nunset label\n{}",
                       gnuplot_quoted(panels[n]), fmt::join(plots, ", "),
                       coloured.empty() ? "" : "unset colorbox\n");
  };
  const Figure figure =
      draw_panels(name, grid,
                  begin_panels("") + axis_script('x', x, shown_x) + axis_script('y', y, shown_y) +
                      colour_script(map, colour.label, min, max, grid),
                  panel, folder);
  const bool is_hatched = std::ranges::any_of(points, &Point::is_unreached);
  return CaptionedFigure{
      figure.svg,
      fmt::format("Colour: {}, {} of the trials in a cell, by {} and {}. All panels share the colour scale. "
                  "White cells have no trial that could be measured.{}",
                  colour.label, map.statistic, shown_x.label, shown_y.label,
                  is_hatched ? " In hatched cells a trial did not do all of this part of its test; "
                               "grey ones have none that could be measured."
                             : "")};
}

}  // namespace osteomill
