#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/visual/brick_levels.h"
#include "osteomill/visual/surface_mesh.h"
#include "osteomill/volume/sampling.h"

#include "surface/brick_mesher.h"

namespace osteomill::testing_support {

inline Vec3 position_of(const MeshVertex& vertex) {
  return {vertex.position_mm[0], vertex.position_mm[1], vertex.position_mm[2]};
}

inline Vec3 normal_of(const MeshVertex& vertex) {
  return {vertex.normal[0], vertex.normal[1], vertex.normal[2]};
}

/// A whole isosurface with one mesh per brick; most are empty.
struct SurfaceMesh {
  SurfaceBricks layout;
  /// Indexed by brick.
  std::vector<BrickMesh> bricks;
};

inline SurfaceMesh mesh_surface(const DensityView& view) {
  SurfaceMesh mesh{SurfaceBricks(view.grid.geometry().dims), {}};
  BrickMesher mesher(view);
  for (std::size_t brick = 0; brick < mesh.layout.count(); ++brick) {
    mesh.bricks.push_back(mesher.mesh(brick));
  }
  return mesh;
}

/// Returns only level 0.
inline BrickMesh mesh_of(const BrickLevels& brick) {
  BrickMesh mesh{{},
                 {brick.indices.begin(), brick.indices.begin() + static_cast<long>(brick.levels[0].count)}};
  if (mesh.empty()) return mesh;
  const std::uint32_t last = *std::max_element(mesh.indices.begin(), mesh.indices.end());
  mesh.vertices.assign(brick.vertices.begin(), brick.vertices.begin() + last + 1);
  return mesh;
}

/// Merges all bricks into one mesh; vertices are shared if their positions agree bit for bit.
inline BrickMesh welded_by_position(const SurfaceMesh& surface) {
  BrickMesh whole;
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const BrickMesh& brick : surface.bricks) {
    std::vector<std::uint32_t> place;
    for (const MeshVertex& vertex : brick.vertices) {
      const auto [at, is_new] =
          known.try_emplace(vertex.position_mm, static_cast<std::uint32_t>(whole.vertices.size()));
      if (is_new) whole.vertices.push_back(vertex);
      place.push_back(at->second);
    }
    for (const std::uint32_t index : brick.indices) whole.indices.push_back(place[index]);
  }
  return whole;
}

/// Returns the directed edges of all triangles, sorted: first vertex in the upper half of the word, second in
/// the lower.
inline std::vector<std::uint64_t> directed_edges(const BrickMesh& mesh) {
  std::vector<std::uint64_t> edges;
  edges.reserve(mesh.indices.size());
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      edges.push_back(std::uint64_t{mesh.indices[n + corner]} << 32 | mesh.indices[n + (corner + 1) % 3]);
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Returns whether every edge is used exactly once in each direction, as in a closed, consistently wound
/// mesh.
inline bool is_closed(const BrickMesh& mesh) {
  const std::vector<std::uint64_t> edges = directed_edges(mesh);
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  std::vector<std::uint64_t> back;
  for (const std::uint64_t edge : edges) back.push_back(edge << 32 | edge >> 32);
  std::sort(back.begin(), back.end());
  return edges == back;
}

/// Returns vertices - edges + triangles of a closed mesh; counts only used vertices.
inline int euler_characteristic(const BrickMesh& mesh) {
  std::vector<std::uint32_t> used = mesh.indices;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return static_cast<int>(used.size()) - static_cast<int>(mesh.indices.size() / 2) +
         static_cast<int>(mesh.triangle_count());
}

/// Uses the divergence theorem; positive if triangles are wound anticlockwise seen from outside.
inline double enclosed_volume_mm3(const BrickMesh& mesh) {
  double volume = 0;
  if (mesh.vertices.empty()) return volume;
  const Vec3 from = position_of(mesh.vertices.front());
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = position_of(mesh.vertices[mesh.indices[n]]) - from;
    const Vec3 b = position_of(mesh.vertices[mesh.indices[n + 1]]) - from;
    const Vec3 c = position_of(mesh.vertices[mesh.indices[n + 2]]) - from;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

/// Returns twice the smallest triangle area.
inline double min_area_mm2(const BrickMesh& mesh) {
  double min = 1e300;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 a = position_of(mesh.vertices[mesh.indices[n]]);
    const Vec3 b = position_of(mesh.vertices[mesh.indices[n + 1]]);
    const Vec3 c = position_of(mesh.vertices[mesh.indices[n + 2]]);
    min = std::min(min, (b - a).cross(c - a).norm() / 2);
  }
  return min;
}

inline bool is_finite(const MeshVertex& vertex) {
  return position_of(vertex).allFinite() && normal_of(vertex).allFinite() && std::isfinite(vertex.density);
}

/// Returns whether the mesh is closed and consistently wound, without NaN, and with unit normals.
inline bool is_sound(const BrickMesh& mesh) {
  return is_closed(mesh) &&
         std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const MeshVertex& vertex) {
           return is_finite(vertex) && std::abs(normal_of(vertex).norm() - 1) < 1e-4;
         });
}

/// Returns the volume above the isovalue in the trilinear densities, sampled at 5 x 5 x 5 points of each
/// cell.
inline double trilinear_volume_mm3(const Volume& volume) {
  const std::array<int, 3>& dims = volume.geometry().dims;
  constexpr int kPoints = 5;
  long inside = 0;
  for (int k = -1; k < dims[2]; ++k) {
    for (int j = -1; j < dims[1]; ++j) {
      for (int i = -1; i < dims[0]; ++i) {
        int bone = 0;
        for (int c = 0; c < 8; ++c) {
          bone += volume.is_bone_in_grid({i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)});
        }
        if (bone == 8) inside += kPoints * kPoints * kPoints;
        if (bone == 0 || bone == 8) continue;
        for (int p = 0; p < kPoints * kPoints * kPoints; ++p) {
          const Vec3 within =
              (Vec3(p % kPoints, p / kPoints % kPoints, p / kPoints / kPoints) + Vec3::Constant(0.5)) /
              kPoints;
          inside += density_at_voxel(volume.grid(), Vec3(i, j, k) + within) > volume.isovalue();
        }
      }
    }
  }
  return static_cast<double>(inside) / (kPoints * kPoints * kPoints) * volume.geometry().voxel_volume_mm3();
}

}  // namespace osteomill::testing_support
