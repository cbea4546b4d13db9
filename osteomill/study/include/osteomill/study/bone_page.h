#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "osteomill/study/page.h"
#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/camera.h"

namespace osteomill {

/// The bytes that a vertex and its two triangles take in a page, in base 64.
inline constexpr std::size_t kVertexBytes = 24;
/// The most vertices of one body: triangles have 16-bit indices.
inline constexpr std::size_t kMaxVertices = 60000;

/// Returns numbers as a page's script reads them: their bytes in base 64.
template <typename Number>
nlohmann::json packed(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

nlohmann::json numbers_of(const Vec3& v);

/// How a page shows a body. Bodies of one name are shown and hidden together.
struct BodyLook {
  std::string name;
  /// The kind of body, for the script: "bone", or one of an exercise's.
  std::string kind = "bone";
  /// "#rrggbb".
  std::string colour = "#e8dcc0";
  double opacity = 1;
  bool is_shown = true;
  /// Bodies with a choice are shown one choice at a time; a list picks it, the last at first. Without,
  /// the body is shown with any.
  std::string choice = {};
};

/// Returns the mesh with at most `max_vertices`, by one vertex for all in a cell (Rossignac and Borrel 1993).
/// Cells double with the distance from a ball: full detail is in it.
BrickMesh simplified(const BrickMesh& mesh, std::size_t max_vertices, double voxel_mm, const Sphere& near);

/// Returns a body for a page's data. The mesh has at most kMaxVertices.
nlohmann::json body_of(const BodyLook& look, const BrickMesh& mesh);

/// Puts into a page's data that its view turns about the ball, seen from where `up_W` points to.
void put_view(nlohmann::json& data, const Sphere& ball, const Vec3& up_W);

/// Gives a page data, and the script that shows its `bodies` in 3D: `Osteomill.showBone(element)`. Data
/// without any takes less.
void put_data(Page& page, const nlohmann::json& data);

}  // namespace osteomill
