#pragma once

#include <array>
#include <vector>

#include "osteomill/haptics/milling_tool.h"

namespace osteomill {

/// Returns `count` points on the tool's centreline in T: the burr's centre, then evenly spaced along the
/// shaft to its end. Throws std::invalid_argument if `count` is below 1. Allocates: not for the tick.
std::vector<Vec3> centreline_vertices(const MillingTool& tool, int count);

/// The paper's number of vertices on the burr's sphere.
inline constexpr int kSphereVertices = 24;

/// Returns 24 points on the burr's sphere, in T: the vertices of a snub cube, the arrangement of 24 points
/// with the largest distance between nearest neighbours (Robinson 1961). No point of the sphere is more than
/// 32 degrees from one.
std::array<Vec3, kSphereVertices> sphere_vertices(const MillingTool& tool);

/// Returns `count` evenly distributed unit vectors on a spiral from pole to pole, with the longitude
/// advancing by the golden angle. Allocates: not for the tick.
std::vector<Vec3> spiral_directions(int count);

/// Returns `count` points on the burr's sphere, in T: the snub cube for 24, otherwise the spiral's directions
/// relaxed like equal charges that repel each other. Throws std::invalid_argument if `count` is below 1.
/// Allocates: not for the tick.
std::vector<Vec3> sphere_vertices(const MillingTool& tool, int count);

/// The paper's number of vertices on a slice of the shaft.
inline constexpr int kSliceVertices = 8;

/// A circle around the shaft: its centre and evenly spaced points on it, in T (slice_vertices()).
struct ShaftSlice {
  Vec3 centre_T;
  std::vector<Vec3> vertices_T;
};

/// Returns the height along z of T at which the shaft emerges from the burr; the shaft is free from here to
/// its end. If the burr encloses the whole shaft, returns the shaft's end.
double shaft_start_mm(const MillingTool& tool);

/// Divides the free length of the shaft into `slices` equal parts and returns for each the circle at its
/// middle, with `vertices` points; the first is nearest the burr. Returns none if the burr encloses the
/// shaft. Throws std::invalid_argument if either count is below 1. Allocates: not for the tick.
std::vector<ShaftSlice> slice_vertices(const MillingTool& tool, int slices, int vertices = kSliceVertices);

}  // namespace osteomill
