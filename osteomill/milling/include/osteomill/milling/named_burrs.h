#pragma once

#include <span>
#include <string_view>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/milling/chip_law.h"

namespace osteomill {

/// A round burr as surgeons and dentists ask for it.
struct NamedBurr {
  /// The name in files and on the command line: "diamond-2.5", "dental-014".
  const char* name;
  /// The name in lists: "diamond 2.5 mm", "no. 4 (1.4 mm)".
  const char* label;
  /// The group in which lists show it: "surgical, diamond".
  const char* kind;
  MillingTool tool;
  BurrEdge edge;
};

/// Returns all burrs that have a name, kind by kind, the smallest first.
std::span<const NamedBurr> named_burrs();
/// Returns the burr of this name; null if there is none.
const NamedBurr* find_burr(std::string_view name);
/// Returns the burr of these sizes and edge; null if none has them.
const NamedBurr* find_burr(const MillingTool& tool, BurrEdge edge);

}  // namespace osteomill
