#pragma once

#include <array>
#include <cstdint>

namespace osteomill {

/// The triangles of one cell of Marching Cubes, as edges of the cube, three a triangle, anticlockwise seen
/// from outside the bone.
///
/// Corner (x, y, z) of the cube is bit x + 2 y + 4 z of a case, set if it is bone. Edge 4 a + u + 2 v runs
/// along axis a, (u, v) being its coordinates along the other two axes in their order.
struct CubeCase {
  std::uint8_t edge_count = 0;
  std::array<std::uint8_t, 15> edges{};
};

/// All 256 cases, made by one rule rather than listed: on each face of the cube the surface cuts off each run
/// of bone corners, so that where a face can be read in two ways (two bone corners across its diagonal) bone
/// is parted, whatever lies behind it. Two neighbouring cells read their common face alike, and the surface
/// has no holes. The polygons so found are cut into fans none of whose inner edges lies in a face of the
/// cube, so that no edge is ever shared by four triangles.
extern const std::array<CubeCase, 256> kCubeCases;

}  // namespace osteomill
