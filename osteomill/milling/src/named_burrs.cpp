#include "osteomill/milling/named_burrs.h"

#include <algorithm>
#include <array>

namespace osteomill {

namespace {

// Shafts: 2.35 mm for straight handpieces, 1.6 mm for friction grip (ISO 1797). The shaft tapers to a neck
// behind a burr that is not wider. Assumed: a neck of 0.6 of the burr's diameter, and the lengths outside the
// handpiece.
constexpr double kNeckShare = 0.6;

constexpr MillingTool tool_of(double diameter_mm, double shank_mm, double length_mm) {
  return {0.5 * diameter_mm, 0.5 * std::min(shank_mm, kNeckShare * diameter_mm), length_mm};
}

constexpr NamedBurr surgical(const char* name, const char* label, double diameter_mm, BurrEdge edge) {
  return {name, label, edge == BurrEdge::cutting ? "surgical, cutting" : "surgical, diamond",
          tool_of(diameter_mm, 2.35, 25), edge};
}

// Sizes and numbers follow ISO 6360: the size is the diameter in tenths of a millimetre.
constexpr NamedBurr dental(const char* name, const char* label, double diameter_mm, BurrEdge edge) {
  return {name, label, edge == BurrEdge::cutting ? "dental, cutting" : "dental, diamond",
          tool_of(diameter_mm, 1.6, 18), edge};
}

constexpr std::array kBurrTable{
    surgical("cutting-0.5", "cutting 0.5 mm", 0.5, BurrEdge::cutting),
    surgical("cutting-0.6", "cutting 0.6 mm", 0.6, BurrEdge::cutting),
    surgical("cutting-0.8", "cutting 0.8 mm", 0.8, BurrEdge::cutting),
    surgical("cutting-1", "cutting 1 mm", 1, BurrEdge::cutting),
    surgical("cutting-1.5", "cutting 1.5 mm", 1.5, BurrEdge::cutting),
    surgical("cutting-2", "cutting 2 mm", 2, BurrEdge::cutting),
    surgical("cutting-2.5", "cutting 2.5 mm", 2.5, BurrEdge::cutting),
    surgical("cutting-3", "cutting 3 mm", 3, BurrEdge::cutting),
    surgical("cutting-4", "cutting 4 mm", 4, BurrEdge::cutting),
    surgical("cutting-5", "cutting 5 mm", 5, BurrEdge::cutting),
    surgical("cutting-6", "cutting 6 mm", 6, BurrEdge::cutting),
    surgical("diamond-0.5", "diamond 0.5 mm", 0.5, BurrEdge::diamond),
    surgical("diamond-0.6", "diamond 0.6 mm", 0.6, BurrEdge::diamond),
    surgical("diamond-0.8", "diamond 0.8 mm", 0.8, BurrEdge::diamond),
    surgical("diamond-1", "diamond 1 mm", 1, BurrEdge::diamond),
    surgical("diamond-1.5", "diamond 1.5 mm", 1.5, BurrEdge::diamond),
    surgical("diamond-2", "diamond 2 mm", 2, BurrEdge::diamond),
    surgical("diamond-2.5", "diamond 2.5 mm", 2.5, BurrEdge::diamond),
    surgical("diamond-3", "diamond 3 mm", 3, BurrEdge::diamond),
    surgical("diamond-4", "diamond 4 mm", 4, BurrEdge::diamond),
    surgical("diamond-5", "diamond 5 mm", 5, BurrEdge::diamond),
    surgical("diamond-6", "diamond 6 mm", 6, BurrEdge::diamond),
    dental("dental-005", "no. 1/4 (0.5 mm)", 0.5, BurrEdge::cutting),
    dental("dental-006", "no. 1/2 (0.6 mm)", 0.6, BurrEdge::cutting),
    dental("dental-008", "no. 1 (0.8 mm)", 0.8, BurrEdge::cutting),
    dental("dental-010", "no. 2 (1 mm)", 1, BurrEdge::cutting),
    dental("dental-012", "no. 3 (1.2 mm)", 1.2, BurrEdge::cutting),
    dental("dental-014", "no. 4 (1.4 mm)", 1.4, BurrEdge::cutting),
    dental("dental-016", "no. 5 (1.6 mm)", 1.6, BurrEdge::cutting),
    dental("dental-018", "no. 6 (1.8 mm)", 1.8, BurrEdge::cutting),
    dental("dental-021", "no. 7 (2.1 mm)", 2.1, BurrEdge::cutting),
    dental("dental-023", "no. 8 (2.3 mm)", 2.3, BurrEdge::cutting),
    dental("dental-diamond-008", "diamond 008 (0.8 mm)", 0.8, BurrEdge::diamond),
    dental("dental-diamond-010", "diamond 010 (1 mm)", 1, BurrEdge::diamond),
    dental("dental-diamond-012", "diamond 012 (1.2 mm)", 1.2, BurrEdge::diamond),
    dental("dental-diamond-014", "diamond 014 (1.4 mm)", 1.4, BurrEdge::diamond),
    dental("dental-diamond-016", "diamond 016 (1.6 mm)", 1.6, BurrEdge::diamond),
    dental("dental-diamond-018", "diamond 018 (1.8 mm)", 1.8, BurrEdge::diamond),
    dental("dental-diamond-021", "diamond 021 (2.1 mm)", 2.1, BurrEdge::diamond),
    dental("dental-diamond-023", "diamond 023 (2.3 mm)", 2.3, BurrEdge::diamond),
};

}  // namespace

std::span<const NamedBurr> named_burrs() {
  return kBurrTable;
}

const NamedBurr* find_burr(std::string_view name) {
  const auto found = std::ranges::find(kBurrTable, name, &NamedBurr::name);
  return found == kBurrTable.end() ? nullptr : &*found;
}

const NamedBurr* find_burr(const MillingTool& tool, BurrEdge edge) {
  const auto found = std::ranges::find_if(
      kBurrTable, [&](const NamedBurr& burr) { return burr.tool == tool && burr.edge == edge; });
  return found == kBurrTable.end() ? nullptr : &*found;
}

}  // namespace osteomill
