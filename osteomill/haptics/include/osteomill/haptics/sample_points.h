#pragma once

#include <array>
#include <vector>

#include "osteomill/haptics/milling_tool.h"

namespace osteomill {

/// `count` points on the tool's centreline in T, the burr's centre first and then evenly along the shaft to
/// its end. Throws std::invalid_argument where `count` is below 1. Allocates: not for the tick.
std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count);

inline constexpr int kSphereVertices = 24;

/// The burr's sphere as 24 points in T: the vertices of a snub cube, the arrangement of 24 points on a sphere
/// whose nearest neighbours are furthest apart (Robinson 1961). No point of the sphere is more than 32
/// degrees from one.
std::array<Vec3, kSphereVertices> sphere_vertices(const MillingTool& tool);

/// Unit vectors evenly along a spiral from pole to pole, the longitude turning by the golden angle from one
/// to the next: `count` directions that favour none. Allocates: not for the tick.
std::vector<Vec3> spiral_directions(int count);

/// The burr's sphere as `count` points in T: the snub cube for 24, and for another count the spiral's
/// directions after they have pushed each other apart as equal charges do. Throws std::invalid_argument where
/// `count` is below 1. Allocates: not for the tick.
std::vector<Vec3> sphere_vertices(const MillingTool& tool, int count);

inline constexpr int kSliceVertices = 8;

/// One circle round the shaft: its centre and points evenly on it, in T.
struct ShaftSlice {
  Vec3 centre_T;
  std::vector<Vec3> vertices_T;
};

/// Where, along z of T, the shaft comes out of the burr: the shaft stands free from here to its end. The
/// shaft's end itself where the burr swallows it whole.
double shaft_start_mm(const MillingTool& tool);

/// The free length of the shaft cut into `slices` equal lengths, each stood for by the circle at its middle,
/// of `vertices` points; the first lies nearest the burr. Empty where the burr swallows the shaft. Throws
/// std::invalid_argument where either count is below 1. Allocates: not for the tick.
std::vector<ShaftSlice> slice_vertices(const MillingTool& tool, int slices, int vertices = kSliceVertices);

}  // namespace osteomill
