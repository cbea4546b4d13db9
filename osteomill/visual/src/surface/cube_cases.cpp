#include "surface/cube_cases.h"

namespace osteomill {

namespace {

using Corner = std::array<int, 3>;

struct Face {
  std::array<int, 4> corners;
  // Edge n lies between corners n and n + 1.
  std::array<int, 4> edges;
};

constexpr int corner_number(const Corner& c) {
  return c[0] + 2 * c[1] + 4 * c[2];
}

constexpr int edge_between(const Corner& a, const Corner& b) {
  std::size_t axis = 0;
  while (a[axis] == b[axis]) ++axis;
  const std::size_t u = axis == 0 ? 1 : 0;
  const std::size_t v = axis == 2 ? 1 : 2;
  return 4 * static_cast<int>(axis) + a[u] + 2 * a[v];
}

// Corners anticlockwise, seen from outside the cube.
constexpr Face make_face(std::size_t axis, int side) {
  constexpr std::array<std::array<int, 2>, 4> round{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::array<Corner, 4> corners{};
  for (std::size_t n = 0; n < 4; ++n) {
    const auto& [u, v] = round[side == 1 ? n : 3 - n];
    corners[n][axis] = side;
    corners[n][(axis + 1) % 3] = u;
    corners[n][(axis + 2) % 3] = v;
  }
  Face face{};
  for (std::size_t n = 0; n < 4; ++n) {
    face.corners[n] = corner_number(corners[n]);
    face.edges[n] = edge_between(corners[n], corners[(n + 1) % 4]);
  }
  return face;
}

constexpr std::array<Face, 6> kFaces{make_face(0, 0), make_face(0, 1), make_face(1, 0),
                                     make_face(1, 1), make_face(2, 0), make_face(2, 1)};

constexpr bool in_one_face(int edge, int other) {
  for (const Face& face : kFaces) {
    bool has_edge = false;
    bool has_other = false;
    for (const int e : face.edges) {
      has_edge = has_edge || e == edge;
      has_other = has_other || e == other;
    }
    if (has_edge && has_other) return true;
  }
  return false;
}

// Returns for each crossed edge the next one along the polygon; -1 for the others.
constexpr std::array<int, 12> next_edges(unsigned bone) {
  std::array<int, 12> next{};
  next.fill(-1);
  for (const Face& face : kFaces) {
    const auto is_bone = [&](std::size_t n) { return (bone >> face.corners[n % 4] & 1) != 0; };
    for (std::size_t n = 0; n < 4; ++n) {
      if (!is_bone(n) || is_bone(n + 3)) continue;
      std::size_t last = n;
      while (is_bone(last + 1)) ++last;
      next[static_cast<std::size_t>(face.edges[(n + 3) % 4])] = face.edges[last % 4];
    }
  }
  return next;
}

struct Polygon {
  std::size_t size = 0;
  std::array<int, 12> edges{};
  constexpr int at(std::size_t n) const { return edges[n % size]; }
};

constexpr bool is_fan_from(const Polygon& polygon, std::size_t apex) {
  for (std::size_t n = 2; n + 1 < polygon.size; ++n) {
    if (in_one_face(polygon.at(apex), polygon.at(apex + n))) return false;
  }
  return true;
}

constexpr void add_fan(CubeCase& cube, const Polygon& polygon) {
  std::size_t apex = 0;
  while (!is_fan_from(polygon, apex)) ++apex;
  for (std::size_t n = 1; n + 1 < polygon.size; ++n) {
    for (const std::size_t corner : {apex, apex + n, apex + n + 1}) {
      cube.edges[cube.edge_count++] = static_cast<std::uint8_t>(polygon.at(corner));
    }
  }
}

constexpr CubeCase make_case(unsigned bone) {
  CubeCase cube;
  std::array<int, 12> next = next_edges(bone);
  for (std::size_t start = 0; start < next.size(); ++start) {
    Polygon polygon;
    for (std::size_t edge = start; next[edge] >= 0;) {
      polygon.edges[polygon.size++] = static_cast<int>(edge);
      const int following = next[edge];
      next[edge] = -1;
      edge = static_cast<std::size_t>(following);
    }
    if (polygon.size > 0) add_fan(cube, polygon);
  }
  return cube;
}

constexpr std::array<CubeCase, 256> make_cases() {
  std::array<CubeCase, 256> cases{};
  for (unsigned bone = 0; bone < 256; ++bone) cases[bone] = make_case(bone);
  return cases;
}

}  // namespace

constinit const std::array<CubeCase, 256> kCubeCases = make_cases();

}  // namespace osteomill
