#include "osteomill/study/bone_page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "report/page_assets.h"

namespace osteomill {

namespace {

using nlohmann::json;

BrickMesh clustered(const BrickMesh& mesh, double cell_mm, const Sphere& near) {
  BrickMesh coarse;
  std::unordered_map<std::uint64_t, std::uint32_t> places;
  std::vector<std::uint32_t> moved(mesh.vertices.size());
  std::vector<float> counts;
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    const Vec3 place_W = vec3_of(mesh.vertices[n].position_mm);
    const double away = std::max((place_W - near.centre_W).norm() / near.radius_mm, 1.0);
    const int level = static_cast<int>(std::log2(away));
    const Vec3 cell = (place_W / std::ldexp(cell_mm, level)).array().floor();
    auto key = static_cast<std::uint64_t>(level);
    for (const double number : {cell.x(), cell.y(), cell.z()})
      key = key << 20 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(number)) & 0xFFFFF);
    const auto [found, is_new] = places.emplace(key, static_cast<std::uint32_t>(counts.size()));
    if (is_new) {
      coarse.vertices.push_back({});
      counts.push_back(0);
    }
    MeshVertex& vertex = coarse.vertices[found->second];
    for (std::size_t axis = 0; axis < 3; ++axis)
      vertex.position_mm[axis] += mesh.vertices[n].position_mm[axis];
    ++counts[found->second];
    moved[n] = found->second;
  }
  for (std::size_t n = 0; n < counts.size(); ++n)
    for (float& coordinate : coarse.vertices[n].position_mm) coordinate /= counts[n];
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const std::uint32_t a = moved[mesh.indices[n]], b = moved[mesh.indices[n + 1]],
                        c = moved[mesh.indices[n + 2]];
    if (a != b && b != c && c != a) coarse.indices.insert(coarse.indices.end(), {a, b, c});
  }
  return coarse;
}

}  // namespace

json numbers_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

BrickMesh simplified(const BrickMesh& mesh, std::size_t max_vertices, double voxel_mm, const Sphere& near) {
  BrickMesh simple = mesh;
  for (double cell_mm = voxel_mm; simple.vertices.size() > max_vertices; cell_mm *= 1.25)
    simple = clustered(mesh, cell_mm, near);
  return simple;
}

json body_of(const BodyStyle& look, const BrickMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshVertex& vertex : mesh.vertices) box.extend(vec3_of(vertex.position_mm));
  // Quantizes positions to 16 bits over the mesh's bounding box.
  constexpr double kSteps = 65535;
  const double step_mm = std::max(box.sizes().maxCoeff(), 1e-6) / kSteps;
  std::vector<std::uint16_t> places;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Vec3 steps = (vec3_of(vertex.position_mm) - box.min()) / step_mm;
    for (const double coordinate : {steps.x(), steps.y(), steps.z()})
      places.push_back(static_cast<std::uint16_t>(std::min(std::round(coordinate), kSteps)));
  }
  return {{"name", look.name},
          {"kind", look.kind},
          {"colour", look.colour},
          {"opacity", look.opacity},
          {"shown", look.is_shown},
          {"choice", look.choice},
          {"origin", numbers_of(box.min())},
          {"step", step_mm},
          {"places", packed(places)},
          {"triangles", packed(std::vector<std::uint16_t>(mesh.indices.begin(), mesh.indices.end()))}};
}

void put_view(json& data, const Sphere& ball, const Vec3& up_W) {
  data["focus"] = numbers_of(ball.centre_W);
  data["radius"] = ball.radius_mm;
  data["up"] = numbers_of(up_W);
}

void put_data(Page& page, const json& data) {
  page.style = bone_view_css();
  if (data.contains("bodies")) page.scripts = {three_js(), orbit_controls_js()};
  page.scripts.push_back(bone_view_js());
  page.data = data.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace osteomill
