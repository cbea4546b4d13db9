#include "app/exercise_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/field.h"
#include "osteomill/exercise/measures.h"

#include "app/option_checks.h"
#include "app/toml_file.h"

namespace osteomill::app {

namespace {

using Keys = std::vector<std::string>;

const Keys kRegionKeys{"label",        "box",   "sphere",     "cylinder",
                       "outside_cone", "shell", "recordings", "at_least"};

Keys with_region(Keys keys) {
  keys.insert(keys.end(), kRegionKeys.begin(), kRegionKeys.end());
  return keys;
}

class ExerciseReader {
 public:
  explicit ExerciseReader(std::string file) : file_(std::move(file)) {}

  Exercise read() const {
    const toml::table all = read_toml(file_);
    require_known(all, "an exercise",
                  {"title", "task", "scan", "iso", "labels", "label_table", "target", "keep", "no_go",
                   "crown", "entry", "tools", "time_s", "step", "item"});
    Exercise exercise;
    exercise.file = file_;
    exercise.title = required_text(all, "an exercise", "title");
    exercise.task = text(all, "task");
    exercise.scan = required_text(all, "an exercise", "scan");
    exercise.isovalue = number(all, "iso", NumberRange::finite());
    exercise.labels = text(all, "labels");
    exercise.label_table = text(all, "label_table");
    read_target_and_keep(all, exercise);
    for (const toml::table* one : tables(all, "no_go")) exercise.no_go.push_back(no_go(*one));
    if (const toml::node* crown = all.get("crown"))
      exercise.crown_axis_W = crown_axis(table(*crown, "crown"));
    if (const toml::node* entry = all.get("entry")) exercise.entry_W_mm = point(*entry, "entry");
    exercise.burrs = burrs(all);
    exercise.time_s = number(all, "time_s", NumberRange::positive());
    for (const toml::table* one : tables(all, "step")) exercise.steps.push_back(step(*one));
    for (const toml::table* one : tables(all, "item")) exercise.items.push_back(item(*one, exercise));
    return exercise;
  }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& reason) const {
    throw error_at(node, file_, reason);
  }
  void require_known(const toml::table& table, const std::string& what, const Keys& keys) const {
    for (const TomlEntry& entry : entries_of(table)) {
      if (std::ranges::find(keys, entry.key) == keys.end())
        refuse(*entry.value, fmt::format("{} has no {}{}", what, entry.key, did_you_mean(entry.key, keys)));
    }
  }

  std::string text(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return "";
    const auto found = node->value_exact<std::string>();
    if (!found || found->empty()) refuse(*node, fmt::format("{} is not a text", key));
    return *found;
  }
  std::string required_text(const toml::table& table, const char* what, const char* key) const {
    std::string found = text(table, key);
    if (found.empty()) refuse(table, fmt::format("{} needs {}", what, key));
    return found;
  }
  std::optional<double> number(const toml::table& table, const char* key, const NumberRange& range) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return std::nullopt;
    return number_in(*node, key, range);
  }
  double number_in(const toml::node& node, const char* key, const NumberRange& range) const {
    const auto found = node.is_number() ? node.value<double>() : std::nullopt;
    if (!found || !range.contains(*found)) refuse(node, fmt::format("{} is not {}", key, range_text(range)));
    return *found;
  }
  double required_number(const toml::table& table, const char* what, const char* key,
                         const NumberRange& range) const {
    const auto found = number(table, key, range);
    if (!found) refuse(table, fmt::format("{} needs {}", what, key));
    return *found;
  }
  Vec3 point(const toml::node& node, const char* key) const {
    const toml::array* list = node.as_array();
    if (list == nullptr || list->size() != 3) refuse(node, fmt::format("{} is not three numbers, mm", key));
    Vec3 point_W;
    for (std::size_t axis = 0; axis < 3; ++axis)
      point_W[static_cast<Eigen::Index>(axis)] = number_in(*list->get(axis), key, NumberRange::finite());
    return point_W;
  }
  Vec3 required_point(const toml::table& table, const char* what, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) refuse(table, fmt::format("{} needs {}", what, key));
    return point(*node, key);
  }
  const toml::table& table(const toml::node& node, const char* key) const {
    if (!node.is_table()) refuse(node, fmt::format("{} is not a table", key));
    return *node.as_table();
  }
  std::vector<const toml::table*> tables(const toml::table& all, const char* key) const {
    std::vector<const toml::table*> found;
    const toml::node* list = all.get(key);
    if (list == nullptr) return found;
    if (!list->is_array_of_tables())
      refuse(*list, fmt::format("{} is not a list of tables, [[{}]]", key, key));
    for (const toml::node& node : *list->as_array()) found.push_back(node.as_table());
    return found;
  }

  Shape box(const toml::table& table) const {
    require_known(table, "a box", {"min", "max"});
    BoxShape box{required_point(table, "a box", "min"), required_point(table, "a box", "max")};
    if (!(box.min_W.array() < box.max_W.array()).all()) refuse(table, "the box's min is not below its max");
    return box;
  }
  Shape sphere(const toml::table& table) const {
    require_known(table, "a sphere", {"center", "radius"});
    return SphereShape{required_point(table, "a sphere", "center"),
                       required_number(table, "a sphere", "radius", NumberRange::positive())};
  }
  Shape cylinder(const toml::table& table) const {
    require_known(table, "a cylinder", {"from", "to", "radius"});
    CylinderShape cylinder{required_point(table, "a cylinder", "from"),
                           required_point(table, "a cylinder", "to"),
                           required_number(table, "a cylinder", "radius", NumberRange::positive())};
    if (cylinder.from_W == cylinder.to_W) refuse(table, "the cylinder's from and to are the same point");
    return cylinder;
  }
  Shape outside_cone(const toml::table& table) const {
    require_known(table, "an outside_cone", {"from", "to", "radius", "radius_to"});
    OutsideConeShape cone{
        required_point(table, "an outside_cone", "from"), required_point(table, "an outside_cone", "to"),
        required_number(table, "an outside_cone", "radius", NumberRange::positive()),
        required_number(table, "an outside_cone", "radius_to", NumberRange::not_negative())};
    if (cone.from_W == cone.to_W) refuse(table, "the cone's from and to are the same point");
    return cone;
  }
  Shape shell(const toml::table& table) const {
    require_known(table, "a shell", {"of", "thickness"});
    if (text(table, "of") != "bone") refuse(table, "a shell needs of = \"bone\"");
    return ShellShape{required_number(table, "a shell", "thickness", NumberRange::positive())};
  }
  Shape recorded(const toml::table& region, const toml::node& node) const {
    RecordedShape shape;
    const toml::array* list = node.as_array();
    if (list == nullptr || list->empty()) refuse(node, "recordings is not a list of files");
    for (const toml::node& one : *list) {
      const auto path = one.value_exact<std::string>();
      if (!path || path->empty()) refuse(one, "recordings is not a list of files");
      shape.recordings.emplace_back(*path);
    }
    const auto count = static_cast<int>(std::min<std::size_t>(list->size(), 1'000'000));
    shape.at_least = static_cast<int>(
        required_number(region, "a region of recordings", "at_least", NumberRange::count(1, count)));
    return shape;
  }

  Region region(const toml::table& table) const {
    Region region;
    region.line = static_cast<int>(table.source().begin.line);
    if (std::string label = text(table, "label"); !label.empty())
      region.shapes.push_back(LabelShape{std::move(label)});
    using Make = Shape (ExerciseReader::*)(const toml::table&) const;
    const std::array<std::pair<const char*, Make>, 5> shapes{{{"box", &ExerciseReader::box},
                                                              {"sphere", &ExerciseReader::sphere},
                                                              {"cylinder", &ExerciseReader::cylinder},
                                                              {"outside_cone", &ExerciseReader::outside_cone},
                                                              {"shell", &ExerciseReader::shell}}};
    for (const auto& [key, make] : shapes) {
      const toml::node* node = table.get(key);
      if (node != nullptr) region.shapes.push_back((this->*make)(this->table(*node, key)));
    }
    if (const toml::node* node = table.get("recordings")) {
      region.shapes.push_back(recorded(table, *node));
    } else if (const toml::node* alone = table.get("at_least")) {
      refuse(*alone, "at_least needs recordings");
    }
    return region;
  }
  Region required_region(const toml::table& table, const char* what) const {
    Region found = region(table);
    if (found.shapes.empty())
      refuse(table,
             fmt::format("{} needs a label, box, sphere, cylinder, outside_cone, shell or recordings", what));
    return found;
  }

  void read_target_and_keep(const toml::table& all, Exercise& exercise) const {
    const toml::node* target = all.get("target");
    if (target == nullptr) refuse(all, "an exercise needs [target]");
    require_known(table(*target, "target"), "target", kRegionKeys);
    exercise.target = required_region(*target->as_table(), "target");
    const toml::node* node = all.get("keep");
    if (node == nullptr) return;
    const toml::table& keep = table(*node, "keep");
    require_known(keep, "keep", with_region({"margin_mm"}));
    exercise.margin_mm = number(keep, "margin_mm", NumberRange::not_negative()).value_or(0);
    if (Region kept = region(keep); !kept.shapes.empty()) exercise.keep = std::move(kept);
  }

  NoGoStructure no_go(const toml::table& table) const {
    require_known(table, "no_go", with_region({"name", "warn_mm", "guard_mm"}));
    NoGoStructure structure;
    structure.name = required_text(table, "no_go", "name");
    structure.region = region(table);
    if (structure.region.shapes.empty()) structure.region.shapes.push_back(LabelShape{structure.name});
    structure.warn_mm = number(table, "warn_mm", NumberRange::not_negative()).value_or(structure.warn_mm);
    // Distances are known up to 12 mm from a structure, which leaves room for the widest burr.
    constexpr NumberRange kGuard{.min = 0, .max = 5};
    structure.guard_mm = number(table, "guard_mm", kGuard);
    return structure;
  }

  Vec3 crown_axis(const toml::table& table) const {
    require_known(table, "crown", {"axis"});
    const Vec3 axis_W = required_point(table, "crown", "axis");
    if (axis_W.isZero()) refuse(table, "the crown's axis has no direction");
    return axis_W.normalized();
  }

  std::vector<AllowedBurr> burrs(const toml::table& all) const {
    std::vector<AllowedBurr> burrs;
    const toml::node* node = all.get("tools");
    if (node == nullptr) return burrs;
    if (!node->is_array() || node->as_array()->empty())
      refuse(*node, "tools is not a list of burrs: names, or radii in mm");
    for (const toml::node& one : *node->as_array()) {
      const auto name = one.value_exact<std::string>();
      burrs.push_back(
          name ? AllowedBurr{named_burr(one, *name)}
               : AllowedBurr{nullptr, number_in(one, "a burr radius of tools", NumberRange::positive())});
    }
    return burrs;
  }
  const NamedBurr* named_burr(const toml::node& node, const std::string& name) const {
    const NamedBurr* burr = find_burr(name);
    if (burr != nullptr) return burr;
    Keys names;
    for (const NamedBurr& one : named_burrs()) names.emplace_back(one.name);
    refuse(node, fmt::format("there is no burr {}{}", name, did_you_mean(name, names)));
  }

  ExerciseStep step(const toml::table& table) const {
    require_known(table, "a step", with_region({"text", "done_percent"}));
    ExerciseStep step{required_text(table, "a step", "text"), required_region(table, "a step")};
    constexpr NumberRange kPercent{.min = 1, .max = 100};
    step.done_percent = number(table, "done_percent", kPercent).value_or(step.done_percent);
    return step;
  }

  // Returns the structure or step that an item names; empty if none.
  std::string part_of(const toml::table& table, const Measure& measure, const Exercise& exercise) const {
    const Keys parts = parts_of(measure, exercise);
    for (const auto& [key, each] :
         {std::pair("structure", Measure::Each::structure), std::pair("step", Measure::Each::step)}) {
      const toml::node* node = table.get(key);
      if (node == nullptr) continue;
      if (measure.each != each) refuse(*node, fmt::format("{} does not take a {}", measure.name, key));
      std::string part = each == Measure::Each::step
                             ? fmt::format("{:g}", number_in(*node, key, NumberRange::count(1)))
                             : text(table, key);
      if (std::ranges::find(parts, part) == parts.end())
        refuse(*node, fmt::format("there is no {} {}{}", each == Measure::Each::step ? "step" : "no_go", part,
                                  did_you_mean(part, parts)));
      return part;
    }
    return "";
  }

  ExerciseItem item(const toml::table& table, const Exercise& exercise) const {
    require_known(table, "an item",
                  {"measure", "structure", "step", "at_least", "at_most", "source", "weight"});
    ExerciseItem item;
    item.line = static_cast<int>(table.source().begin.line);
    item.measure = required_text(table, "an item", "measure");
    const Measure* measure = find_measure(item.measure);
    if (measure == nullptr) {
      refuse(*table.get("measure"), fmt::format("there is no measure {}{}", item.measure,
                                                did_you_mean(item.measure, measure_names())));
    }
    item.part = part_of(table, *measure, exercise);
    item.at_least = number(table, "at_least", NumberRange::finite());
    item.at_most = number(table, "at_most", NumberRange::finite());
    if (!item.at_least && !item.at_most)
      refuse(table, fmt::format("the item {} needs at_least or at_most", item.measure));
    item.source = text(table, "source");
    item.weight = number(table, "weight", NumberRange::not_negative());
    return item;
  }

  std::string file_;
};

}  // namespace

Exercise read_exercise_file(const std::string& file) {
  return ExerciseReader(file).read();
}

}  // namespace osteomill::app
