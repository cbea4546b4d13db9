#pragma once

#include <array>
#include <vector>

#include "osteomill/haptics/milling_tool.h"

namespace osteomill {

/// Returns `count` points on the tool's centreline in T, the burr's centre first and then evenly along the
/// shaft to its end. Throws std::invalid_argument if `count` is below 1. Allocates: not for the tick.
std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count);

/// The paper's number of vertices on the burr's sphere.
inline constexpr int kSphereVertices = 24;

/// Returns the burr's sphere as 24 points in T: the vertices of a snub cube, the arrangement of 24 points on
/// a sphere whose nearest neighbours are furthest apart (Robinson 1961). No point of the sphere is more than
/// 32 degrees from one.
std::array<Vec3, kSphereVertices> sphere_vertices(const MillingTool& tool);

/// Returns unit vectors evenly along a spiral from pole to pole, the longitude turning by the golden angle
/// from one to the next: `count` directions that favour none. Allocates: not for the tick.
std::vector<Vec3> spiral_directions(int count);

/// Returns the burr's sphere as `count` points in T: the snub cube for 24, and for another count the spiral's
/// directions after they have pushed each other apart as equal charges do. Throws std::invalid_argument if
/// `count` is below 1. Allocates: not for the tick.
std::vector<Vec3> sphere_vertices(const MillingTool& tool, int count);

/// The paper's number of vertices on a slice of the shaft.
inline constexpr int kSliceVertices = 8;

/// One circle round the shaft: its centre and points evenly on it, in T (slice_vertices()).
struct ShaftSlice {
  Vec3 centre_T;
  std::vector<Vec3> vertices_T;
};

/// Returns the height along z of T at which the shaft comes out of the burr: the shaft stands free from here
/// to its end. If the burr swallows the whole shaft, returns the shaft's end.
double shaft_start_mm(const MillingTool& tool);

/// Cuts the free length of the shaft into `slices` equal lengths and returns for each the circle at its
/// middle, of `vertices` points; the first lies nearest the burr. Returns none if the burr swallows the
/// shaft. Throws std::invalid_argument if either count is below 1. Allocates: not for the tick.
std::vector<ShaftSlice> slice_vertices(const MillingTool& tool, int slices, int vertices = kSliceVertices);

}  // namespace osteomill
