#include "app/study_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "osteomill/haptics/algorithms.h"

#include "app/option_checks.h"
#include "app/toml_file.h"

namespace osteomill::app {

namespace {

using Keys = std::vector<std::string>;

class Reader {
 public:
  Reader(std::string file, const Keys& keys) : file_(std::move(file)), keys_(keys) {}

  StudyDesign read() const {
    const toml::table file = read_toml(file_);
    for (const TomlEntry& entry : entries_of(file))
      require_one_of(entry, {"title", "test", "findings", "fixed", "grid", "list", "latin-hypercube", "map"});
    StudySettings fixed;
    for (const TomlEntry& entry : options_of(table(file, "fixed")))
      fixed.emplace_back(entry.key, text(entry));
    std::vector<StudyAxis> grid;
    for (const TomlEntry& entry : options_of(table(file, "grid"))) grid.push_back(axis(entry));
    if (const toml::node* list = file.get("list")) grid.push_back(axis({"list", list}));
    LatinHypercube hypercube = latin_hypercube(table(file, "latin-hypercube"));
    try {
      StudyDesign design(std::move(fixed), std::move(grid), std::move(hypercube));
      if (design.varied().empty())
        throw std::invalid_argument("has no trials: it needs a grid, a list or a latin-hypercube");
      describe(file, design);
      return design;
    } catch (const std::invalid_argument& error) {
      throw InputError(file_, error.what());
    }
  }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& reason) const {
    throw error_at(node, file_, reason);
  }
  void require_one_of(const TomlEntry& entry, const Keys& keys) const {
    if (std::find(keys.begin(), keys.end(), entry.key) == keys.end())
      refuse(*entry.value, fmt::format("a study has no {}{}", entry.key, did_you_mean(entry.key, keys)));
  }

  const toml::table& table(const toml::table& file, const char* name) const {
    static const toml::table none;
    const toml::node* node = file.get(name);
    if (node == nullptr) return none;
    if (!node->is_table()) refuse(*node, fmt::format("{} is not a table", name));
    return *node->as_table();
  }

  void require_known(const TomlEntry& option) const {
    const Keys known = is_algorithm_setting(option.key) ? algorithm_names() : keys_;
    if (std::ranges::find(known, option.key.substr(0, option.key.find('.'))) == known.end())
      refuse(*option.value,
             fmt::format("a trial has no option {}{}", option.key, did_you_mean(option.key, known)));
  }

  // Returns the value in the form of the command line: "0,0,-1".
  std::string text(const TomlEntry& entry) const {
    require_known(entry);
    return fmt::format("{}", fmt::join(option_values(*entry.value, file_, entry.key), ","));
  }

  template <typename Value>
  Value value(const toml::table& table, const char* key, Value otherwise) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return otherwise;
    const auto found = node->value<Value>();
    if (!found) refuse(*node, fmt::format("{} has the wrong type", key));
    return *found;
  }

  // Returns the range of a table {from, to}; empty if the entry is not such a table.
  std::optional<StudyRange> range(const TomlEntry& entry) const {
    const toml::table* range_table = entry.value->as_table();
    if (range_table == nullptr || !range_table->contains("from")) return std::nullopt;
    for (const TomlEntry& key : entries_of(*range_table)) require_one_of(key, {"from", "to", "steps", "log"});
    const StudyRange range{value(*range_table, "from", 0.0), value(*range_table, "to", 0.0),
                           value(*range_table, "log", false)};
    if (!std::isfinite(range.from) || !std::isfinite(range.to) || range.to < range.from ||
        (range.logarithmic && !(range.from > 0)))
      refuse(*entry.value,
             fmt::format("{} has an invalid range from {} to {}", entry.key, range.from, range.to));
    return range;
  }

  StudyAxis axis(const TomlEntry& entry) const {
    StudyAxis axis;
    if (const auto found = range(entry)) {
      require_known(entry);
      const auto steps = value<int64_t>(*entry.value->as_table(), "steps", 0);
      if (steps < 1 || steps > 1'000'000)
        refuse(*entry.value, fmt::format("{} needs steps, 1 or more", entry.key));
      for (const double number : steps_of(*found, static_cast<std::size_t>(steps)))
        axis.push_back({{entry.key, fmt::format("{}", number)}});
      return axis;
    }
    const toml::array* values = entry.value->as_array();
    if (values == nullptr)
      refuse(*entry.value, fmt::format("{} is neither a list of values nor a range", entry.key));
    if (values->empty()) refuse(*entry.value, fmt::format("{} has no values", entry.key));
    for (const toml::node& node : *values) {
      StudySettings settings;
      if (const toml::table* together = node.as_table()) {
        for (const TomlEntry& one : options_of(*together)) settings.emplace_back(one.key, text(one));
      } else {
        settings.emplace_back(entry.key, text({entry.key, &node}));
      }
      axis.push_back(std::move(settings));
    }
    return axis;
  }

  LatinHypercube latin_hypercube(const toml::table& table) const {
    LatinHypercube hypercube;
    if (table.empty()) return hypercube;
    const auto trials = value<int64_t>(table, "trials", 0);
    if (trials < 1 || trials > 10'000'000)
      refuse(table, "latin-hypercube needs trials, from 1 to 10,000,000");
    hypercube.trials = static_cast<std::size_t>(trials);
    hypercube.seed = static_cast<std::uint64_t>(value<int64_t>(table, "seed", 1));
    for (const TomlEntry& entry : options_of(table)) {
      if (entry.key == "trials" || entry.key == "seed") continue;
      if (const auto found = range(entry)) {
        require_known(entry);
        hypercube.axes.push_back({entry.key, *found, {}});
      } else {
        hypercube.axes.push_back({entry.key, {}, axis(entry)});
      }
    }
    if (hypercube.axes.empty()) refuse(table, "latin-hypercube has no options to vary");
    return hypercube;
  }

  void describe(const toml::table& file, StudyDesign& design) const {
    design.title = value<std::string>(file, "title", "");
    design.findings = value(file, "findings", false);
    const Keys tests{std::begin(kStudyTests), std::end(kStudyTests)};
    const auto test = std::find(tests.begin(), tests.end(), choice(file, "test", tests));
    design.test = static_cast<StudyTest>(test - tests.begin());
    if (design.findings && design.test != StudyTest::milling)
      refuse(*file.get("findings"), "findings need the test milling");
    const toml::node* maps = file.get("map");
    if (maps == nullptr) return;
    if (!maps->is_array_of_tables()) refuse(*maps, "map is not a list of tables, [[map]]");
    for (const toml::node& node : *maps->as_array())
      design.maps.push_back(map(*node.as_table(), design.test));
  }

  StudyMap map(const toml::table& table, StudyTest test) const {
    for (const TomlEntry& entry : entries_of(table))
      require_one_of(entry, {"title", "x", "y", "colour", "panels", "part", "statistic", "log-colour",
                             "line-of-equality"});
    StudyMap map;
    map.title = value(table, "title", std::string());
    map.x = quantity(table, "x", "", test);
    map.y = quantity(table, "y", "", test);
    map.colour = quantity(table, "colour", "", test);
    map.panels = quantity(table, "panels", "algorithm", test);
    const auto parts = parts_of(test);
    map.part = choice(table, "part", {parts.begin(), parts.end()});
    map.statistic = choice(table, "statistic", {"median", "mean", "max"});
    map.logarithmic_colour = value(table, "log-colour", false);
    map.line_of_equality = value(table, "line-of-equality", false);
    return map;
  }

  // Returns the value of `key`; the first choice if it is missing.
  std::string choice(const toml::table& table, const char* key, const Keys& choices) const {
    const std::string chosen = value(table, key, choices.front());
    if (std::find(choices.begin(), choices.end(), chosen) == choices.end())
      refuse(*table.get(key), fmt::format("there is no {} {}{}", key, chosen, did_you_mean(chosen, choices)));
    return chosen;
  }

  std::string quantity(const toml::table& table, const char* key, const std::string& otherwise,
                       StudyTest test) const {
    const std::string shown = value(table, key, otherwise);
    const toml::node& at = table.contains(key) ? *table.get(key) : static_cast<const toml::node&>(table);
    if (shown.empty()) refuse(at, fmt::format("a map needs {}", key));
    Keys known = keys_;
    for (const Field<TrialRow>& column : columns_of(test)) known.push_back(column.name);
    for (const std::string& name : operands_of(shown)) {
      if (name.find('.') == std::string::npos && std::find(known.begin(), known.end(), name) == known.end())
        refuse(at, fmt::format("there is no option and no column {}{}", name, did_you_mean(name, known)));
    }
    return shown;
  }

  std::string file_;
  // Names of a trial's options, except for the algorithms' own settings.
  Keys keys_;
};

}  // namespace

StudyDesign read_study_file(const std::string& file, const std::vector<std::string>& keys) {
  return Reader(file, keys).read();
}

}  // namespace osteomill::app
