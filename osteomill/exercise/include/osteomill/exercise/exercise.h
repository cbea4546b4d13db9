#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "osteomill/milling/named_burrs.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/structure_distance.h"

namespace osteomill {

/// Outermost layer of the bone. Enclosed cavities do not count as outside.
struct ShellShape {
  double thickness_mm = 0;
};
/// Everything outside a conical frustum with flat ends.
struct OutsideConeShape {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::UnitZ();
  double radius_mm = 0;
  /// Radius at the end `to_W`.
  double radius_to_mm = 0;
};
/// A structure of the label map, by name (case does not matter) or value.
struct LabelShape {
  std::string label;
};
/// Bone that at least `at_least` of these recordings removed.
struct RecordedShape {
  std::vector<std::filesystem::path> recordings;
  int at_least = 1;
};
/// One shape of a region.
using Shape = std::variant<BoxShape, SphereShape, CylinderShape, OutsideConeShape, ShellShape, LabelShape,
                           RecordedShape>;

/// A part of the scan: the intersection of its shapes.
struct Region {
  std::vector<Shape> shapes;
  /// Line of the file, for error messages.
  int line = 0;
};

/// A structure that the burr must not touch.
struct NoGoStructure {
  std::string name;
  Region region;
  /// Distance of the burr's surface below which the trainee is warned. No facial nerve was damaged at 3 mm,
  /// unlike at 1 and 2 mm (Voormolen et al.).
  double warn_mm = 3;
  /// Distance at which the burr's surface is held off; nothing if it is not.
  std::optional<double> guard_mm = {};
};

struct ExerciseStep {
  std::string text;
  Region region;
  /// Share of the region's bone that must be removed, percent.
  double done_percent = 95;
};

/// A measure with at least one limit.
struct ExerciseItem {
  std::string measure;
  /// Structure or step number to measure; empty means all, or that the measure has no parts.
  std::string part;
  std::optional<double> at_least;
  std::optional<double> at_most;
  std::string source;
  /// Weight of the item in the source, if it has one.
  std::optional<double> weight;
  int line = 0;
};

/// A permitted burr: a named one, or any of this radius.
struct AllowedBurr {
  const NamedBurr* named = nullptr;
  double radius_mm = 0;

  /// Returns whether the setup uses this burr.
  bool is_in(const MillingSetup& setup) const;
  /// Sets the setup's burr: a named one as it is, otherwise the radius, with a thinner shaft.
  void put_into(MillingSetup& setup) const;
  /// Returns its name for people: "diamond 2 mm", "round 1.5 mm".
  std::string label() const;
};

/// A task on a scan, and its criteria.
struct Exercise {
  /// Its file; errors name it, and paths in it are relative to its folder.
  std::filesystem::path file;
  std::string title;
  std::string task;
  /// Path, or "builtin:NAME".
  std::string scan;
  std::optional<double> isovalue;
  std::filesystem::path labels;
  std::filesystem::path label_table;
  Region target;
  /// Removed bone counts as outside only if it is farther than this from the target.
  double margin_mm = 0;
  /// Bone that must stay, regardless of its distance from the target.
  std::optional<Region> keep;
  std::vector<NoGoStructure> no_go;
  /// Unit vector along which a prepared crown is removed; nothing if the exercise has no crown.
  std::optional<Vec3> crown_axis_W;
  std::optional<Vec3> entry_W_mm;
  /// Permitted burrs; empty for any.
  std::vector<AllowedBurr> burrs;
  std::optional<double> time_s;
  std::vector<ExerciseStep> steps;
  std::vector<ExerciseItem> items;
};

}  // namespace osteomill
