#pragma once

#include <span>
#include <string_view>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/milling/chip_law.h"

namespace osteomill {

/// A round burr with its catalogue name.
struct NamedBurr {
  /// The name in files and on the command line: "diamond-2.5", "dental-014".
  const char* name;
  /// The name in lists: "diamond 2.5 mm", "no. 4 (1.4 mm)".
  const char* label;
  /// The group under which lists show it: "surgical, diamond".
  const char* kind;
  MillingTool tool;
  BurrEdge edge;
};

/// Returns all named burrs, grouped by kind, in ascending size.
std::span<const NamedBurr> named_burrs();
/// Returns the burr with this name, or null.
const NamedBurr* find_burr(std::string_view name);
/// Returns the burr with this geometry and edge, or null.
const NamedBurr* find_burr(const MillingTool& tool, BurrEdge edge);

}  // namespace osteomill
