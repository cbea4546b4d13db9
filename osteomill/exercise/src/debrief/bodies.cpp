#include "debrief/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

#include "osteomill/visual/surface_mesh.h"

namespace osteomill {

namespace {

using nlohmann::json;

// Moves every vertex halfway to the mean of its neighbours, to smooth the steps of a voxel surface.
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

// Returns the surface of those voxels of a set that `is_wanted` accepts; empty if there are none.
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

// Returns for each vertex of a structure the thickness of the bone left over it in 1/31 mm; 255 if milling
// did not thin it.
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

void add_bodies(json& data, const Attempt& attempt, const LabelMap& colours, std::size_t max_vertices,
                const std::string& choice) {
  const PlacedExercise& exercise = *attempt.exercise;
  const Sphere near = target_ball(exercise);
  const std::size_t others = 4 + exercise.structures.size();
  const auto add = [&](BodyStyle look, const BrickMesh& mesh,
                       const std::vector<ThicknessLeft>* left = nullptr) {
    if (mesh.empty()) return;
    look.choice = choice;
    const std::size_t most = look.kind == "bone" ? std::min(max_vertices / 2, kMaxVertices)
                                                 : std::min(max_vertices / 2 / others, max_vertices / 10);
    const BrickMesh simple = simplified(mesh, most, exercise.scan.spacing_mm.minCoeff(), near);
    json& body = data["bodies"].emplace_back(body_of(look, simple));
    if (left != nullptr) body["thickness"] = packed(thickness_at(simple, *left, exercise.scan));
  };
  const auto colour_of = [&](std::size_t n) {
    return hex_colour(colours.labels()[std::min(n, colours.labels().size() - 1)]);
  };
  const auto surface = [&](const VoxelSet& voxels, const auto& is_wanted) {
    return surface_of(voxels, exercise.scan, is_wanted);
  };
  const auto all = [](const VoxelIndex&) { return true; };
  add({.name = "bone", .opacity = exercise.structures.empty() ? 1 : 0.5},
      mesh_in_one_piece(DensityView(attempt.after)));
  add({"target", "target", colour_of(0), 0.2}, surface(exercise.target, all));
  add({"remaining target", "left", "#0f7a3d"},
      surface(exercise.target, [&](const VoxelIndex& v) { return !attempt.removed.contains(v); }));
  add({"removed outside", "outside", "#e8590c", 0.8},
      surface(attempt.removed, [&](const VoxelIndex& v) { return exercise.is_outside(v); }));
  add({"bone to be kept", "keep", colour_of(1), 0.25, false}, surface(exercise.keep, all));
  for (std::size_t n = 0; n < exercise.structures.size(); ++n)
    add({exercise.structures[n].name, "structure", colour_of(n + 2)},
        surface(exercise.structures[n].voxels, all), &attempt.thickness_left[n]);
}

}  // namespace osteomill
