#include "debrief/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "osteomill/visual/surface_mesh.h"

namespace osteomill {

namespace {

using nlohmann::json;

// Vertices of the bone, and of each other body. With 16-bit indices all of them take 3 MB of a page at most.
constexpr std::size_t kBoneVertices = 60000, kBodyVertices = 12000;

// Returns the mesh with one vertex for all in a cell (Rossignac and Borrel 1993). Cells double with the
// distance from a ball: full detail is in it.
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

BrickMesh simplified(const BrickMesh& mesh, std::size_t most, double voxel_mm, const Sphere& near) {
  BrickMesh simple = mesh;
  for (double cell_mm = voxel_mm; simple.vertices.size() > most; cell_mm *= 1.25)
    simple = clustered(mesh, cell_mm, near);
  return simple;
}

// Moves every vertex half of the way to the middle of its neighbours, so that a surface of voxels has no
// steps.
void smooth(BrickMesh& mesh) {
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
    std::vector<double> counts(mesh.vertices.size(), 0);
    for (std::size_t n = 0; n < mesh.indices.size(); ++n) {
      const std::size_t next = n % 3 == 2 ? n - 2 : n + 1;
      sums[mesh.indices[n]] += vec3_of(mesh.vertices[mesh.indices[next]].position_mm);
      ++counts[mesh.indices[n]];
    }
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      MeshVertex& vertex = mesh.vertices[n];
      if (counts[n] > 0) put(0.5 * (vec3_of(vertex.position_mm) + sums[n] / counts[n]), vertex.position_mm);
    }
  }
}

// Returns the surface of a set's voxels that are wanted; empty if none is.
template <typename Wanted>
BrickMesh surface_of(const VoxelSet& voxels, const GridGeometry& scan, const Wanted& is_wanted) {
  VoxelBox box;
  voxels.for_each([&](const VoxelIndex& v) {
    if (is_wanted(v)) box.include(v);
  });
  if (box.empty()) return {};
  box = box.grown(1);
  GridGeometry own = scan;
  own.dims = box.dims();
  own.origin_mm = scan.world_from_voxel(box.first);
  std::vector<float> inside(own.voxel_count(), 0);
  voxels.for_each([&](const VoxelIndex& v) {
    if (is_wanted(v))
      inside[row_major(own.dims, v.i - box.first.i, v.j - box.first.j, v.k - box.first.k)] = 1;
  });
  BrickMesh mesh = mesh_in_one_piece(DensityView(Volume(DensityGrid(own, std::move(inside)), 0.5)));
  smooth(mesh);
  return mesh;
}

// Puts the mesh into a body: places in 16 bits of the mesh's box, and triangles.
void pack(json& body, const BrickMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshVertex& vertex : mesh.vertices) box.extend(vec3_of(vertex.position_mm));
  constexpr double kSteps = 65535;
  const Vec3 low = box.min();
  const double step_mm = std::max(box.sizes().maxCoeff(), 1e-6) / kSteps;
  std::vector<std::uint16_t> places;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Vec3 steps = (vec3_of(vertex.position_mm) - low) / step_mm;
    for (const double coordinate : {steps.x(), steps.y(), steps.z()})
      places.push_back(static_cast<std::uint16_t>(std::min(std::round(coordinate), kSteps)));
  }
  body["origin"] = {low.x(), low.y(), low.z()};
  body["step"] = step_mm;
  body["places"] = packed(places);
  // Simplified meshes have fewer vertices than that.
  body["triangles"] = packed(std::vector<std::uint16_t>(mesh.indices.begin(), mesh.indices.end()));
}

// Returns for each vertex of a structure the bone left over it in 1/31 mm, 255 if none was taken there.
std::vector<std::uint8_t> thickness_at(const BrickMesh& mesh, const std::vector<ThicknessLeft>& left,
                                       const GridGeometry& scan) {
  std::unordered_map<std::size_t, double> left_mm;
  for (const ThicknessLeft& one : left)
    left_mm[row_major(scan.dims, one.place.i, one.place.j, one.place.k)] = one.left_mm;
  std::vector<std::uint8_t> thickness;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Vec3 place = scan.voxel_from_world(vec3_of(vertex.position_mm)).array().round();
    const VoxelIndex v{static_cast<int>(place.x()), static_cast<int>(place.y()), static_cast<int>(place.z())};
    double least_mm = std::numeric_limits<double>::quiet_NaN();
    for_each(VoxelBox{v, v}.grown(1).intersected(scan.all_voxels()), [&](const VoxelIndex& by) {
      const auto found = left_mm.find(row_major(scan.dims, by.i, by.j, by.k));
      if (found != left_mm.end()) least_mm = std::fmin(least_mm, found->second);
    });
    thickness.push_back(std::isnan(least_mm) ? 255
                                             : static_cast<std::uint8_t>(std::min(31 * least_mm, 248.0)));
  }
  return thickness;
}

}  // namespace

Sphere target_ball(const PlacedExercise& exercise) {
  Eigen::AlignedBox3d box;
  exercise.target.for_each([&](const VoxelIndex& v) { box.extend(exercise.scan.world_from_voxel(v)); });
  return {box.center(), 0.5 * box.diagonal().norm() + exercise.scan.spacing_mm.maxCoeff()};
}

json bodies_of(const Attempt& attempt, const LabelMap& colours) {
  const PlacedExercise& exercise = *attempt.exercise;
  const Sphere near = target_ball(exercise);
  json bodies = json::array();
  const auto add = [&](json body, std::size_t most, BrickMesh mesh,
                       const std::vector<ThicknessLeft>* left = nullptr) {
    if (mesh.empty()) return;
    mesh = simplified(mesh, most, exercise.scan.spacing_mm.minCoeff(), near);
    pack(body, mesh);
    if (left != nullptr) body["thickness"] = packed(thickness_at(mesh, *left, exercise.scan));
    bodies.push_back(std::move(body));
  };
  const auto look = [](const std::string& name, const char* kind, const std::string& colour, double opacity,
                       bool is_shown = true) {
    return json{
        {"name", name}, {"kind", kind}, {"colour", colour}, {"opacity", opacity}, {"shown", is_shown}};
  };
  const auto colour_of = [&](std::size_t n) {
    const std::array<std::uint8_t, 3>& rgb =
        colours.labels()[std::min(n, colours.labels().size() - 1)].colour;
    return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
  };
  const auto all = [](const VoxelIndex&) { return true; };
  add(look("bone", "bone", "#e8dcc0", exercise.structures.empty() ? 1 : 0.5), kBoneVertices,
      mesh_in_one_piece(DensityView(attempt.after)));
  add(look("target", "target", colour_of(0), 0.2), kBodyVertices,
      surface_of(exercise.target, exercise.scan, all));
  add(look("left of the target", "left", "#0f7a3d", 1), kBodyVertices,
      surface_of(exercise.target, exercise.scan,
                 [&](const VoxelIndex& v) { return !attempt.removed.contains(v); }));
  add(look("removed outside", "outside", "#e8590c", 0.8), kBodyVertices,
      surface_of(attempt.removed, exercise.scan,
                 [&](const VoxelIndex& v) { return exercise.is_outside(v); }));
  add(look("bone to be kept", "keep", colour_of(1), 0.25, false), kBodyVertices,
      surface_of(exercise.keep, exercise.scan, all));
  for (std::size_t n = 0; n < exercise.structures.size(); ++n) {
    add(look(exercise.structures[n].name, "structure", colour_of(n + 2), 1), kBodyVertices,
        surface_of(exercise.structures[n].voxels, exercise.scan, all), &attempt.thickness_left[n]);
  }
  return bodies;
}

}  // namespace osteomill
