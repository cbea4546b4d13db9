#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "osteomill/study/page.h"
#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/camera.h"

namespace osteomill {

/// Bytes that a vertex and its two triangles take in a page, in base 64.
inline constexpr std::size_t kVertexBytes = 24;
/// Maximum number of vertices of a body: triangles have 16-bit indices.
inline constexpr std::size_t kMaxVertices = 60000;

/// Encodes numbers for a page's script: their bytes in base 64.
template <typename Number>
nlohmann::json packed(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

nlohmann::json numbers_of(const Vec3& v);

/// Appearance of a body in a page. Bodies of the same name are shown and hidden together.
struct BodyStyle {
  std::string name;
  /// Kind of body, for the script: "bone", or one of an exercise's.
  std::string kind = "bone";
  /// "#rrggbb".
  std::string colour = "#e8dcc0";
  double opacity = 1;
  bool is_shown = true;
  /// Bodies with a choice are shown one choice at a time; a list selects it, initially the last. A body
  /// without a choice is always shown.
  std::string choice = {};
};

/// Simplifies a mesh to at most `max_vertices` by merging the vertices of each cell (Rossignac and Borrel
/// 1993). Cell size doubles with the distance from the ball `near`, which keeps full detail.
BrickMesh simplified(const BrickMesh& mesh, std::size_t max_vertices, double voxel_mm, const Sphere& near);

/// Returns a body for a page's data. The mesh must have at most kMaxVertices.
nlohmann::json body_of(const BodyStyle& look, const BrickMesh& mesh);

/// Sets the initial view in a page's data: it orbits the ball, seen from the direction `up_W`.
void put_view(nlohmann::json& data, const Sphere& ball, const Vec3& up_W);

/// Adds data to a page, and the script that shows its `bodies` in 3D: `Osteomill.showBone(element)`. Without
/// bodies the script is smaller.
void put_data(Page& page, const nlohmann::json& data);

}  // namespace osteomill
