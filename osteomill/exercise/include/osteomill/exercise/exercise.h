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

/// The outermost layer of the bone. Hollows that the bone encloses have none.
struct ShellShape {
  double thickness_mm = 0;
};
/// Everything outside of a cone's frustum with flat ends.
struct OutsideConeShape {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::UnitZ();
  double radius_mm = 0;
  /// The radius at the end `to_W`.
  double radius_to_mm = 0;
};
/// A structure of the label map, by name (case does not matter) or value.
struct LabelShape {
  std::string label;
};
/// The bone that at least `at_least` of these recordings removed.
struct RecordedShape {
  std::vector<std::filesystem::path> recordings;
  int at_least = 1;
};
/// One shape of a region.
using Shape = std::variant<BoxShape, SphereShape, CylinderShape, OutsideConeShape, ShellShape, LabelShape,
                           RecordedShape>;

/// A part of the scan: everything that lies in all of its shapes.
struct Region {
  std::vector<Shape> shapes;
  /// The line of the file that errors name.
  int line = 0;
};

/// A structure that the burr must not touch.
struct NoGoStructure {
  std::string name;
  Region region;
  /// The distance of the burr's surface below which the trainee is warned. None of the facial nerves was
  /// damaged at 3 mm, while 1 and 2 mm failed (Voormolen et al.).
  double warn_mm = 3;
  /// The distance at which the burr's surface is held off; nothing if it is not.
  std::optional<double> guard_mm = {};
};

struct ExerciseStep {
  std::string text;
  Region region;
  /// The share of the region's bone that must be gone, percent.
  double done_percent = 95;
};

/// A measure with its limits; at least one of them is there.
struct ExerciseItem {
  std::string measure;
  /// The structure, or the number of the step, that it is measured of; empty for all, or if there is nothing
  /// to choose.
  std::string part;
  std::optional<double> at_least;
  std::optional<double> at_most;
  std::string source;
  /// The weight that the source gives the item, if it has one.
  std::optional<double> weight;
  int line = 0;
};

/// A burr that may be used: one by its name, or any of this radius.
struct AllowedBurr {
  const NamedBurr* named = nullptr;
  double radius_mm = 0;

  /// Returns whether the setup has it.
  bool is_in(const MillingSetup& setup) const;
  /// Puts it into the setup: one by name as it is, or else its radius with a shaft that is thinner than it.
  void put_into(MillingSetup& setup) const;
  /// Returns what people call it: "diamond 2 mm", "round 1.5 mm".
  std::string label() const;
};

/// A task on a scan, and what counts as doing it well.
struct Exercise {
  /// The file; errors name it, and its paths are relative to its folder.
  std::filesystem::path file;
  std::string title;
  std::string task;
  /// A path, or "builtin:NAME".
  std::string scan;
  std::optional<double> isovalue;
  std::filesystem::path labels;
  std::filesystem::path label_table;
  Region target;
  /// Removed bone counts as outside only if it lies farther than this from the target.
  double margin_mm = 0;
  /// Bone that must stay, wherever it lies.
  std::optional<Region> keep;
  std::vector<NoGoStructure> no_go;
  /// The unit vector along which a prepared crown is taken off; nothing if none is prepared.
  std::optional<Vec3> crown_axis_W;
  std::optional<Vec3> entry_W_mm;
  /// The burrs that may be used; empty for any.
  std::vector<AllowedBurr> burrs;
  std::optional<double> time_s;
  std::vector<ExerciseStep> steps;
  std::vector<ExerciseItem> items;
};

}  // namespace osteomill
