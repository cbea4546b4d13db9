#include "osteomill/visual/surface_mesh.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "surface/brick_mesher.h"

namespace osteomill {

namespace {

// Vertex shared by several bricks, with the grid edge on which it lies.
struct SharedVertex {
  std::uint64_t edge;
  std::uint32_t vertex;
};

// Returns for each vertex the first vertex on the same edge.
std::vector<std::uint32_t> first_of_same_edge(std::size_t count, std::vector<SharedVertex> shared) {
  std::vector<std::uint32_t> first(count);
  for (std::size_t n = 0; n < count; ++n) first[n] = static_cast<std::uint32_t>(n);
  std::sort(shared.begin(), shared.end(), [](const SharedVertex& a, const SharedVertex& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.vertex < b.vertex;
  });
  for (std::size_t n = 1; n < shared.size(); ++n) {
    if (shared[n].edge == shared[n - 1].edge) first[shared[n].vertex] = first[shared[n - 1].vertex];
  }
  return first;
}

// Removes the vertices that are not the first on their edge.
void merge_vertices(BrickMesh& mesh, const std::vector<std::uint32_t>& first) {
  std::vector<std::uint32_t> place(first.size());
  std::uint32_t kept = 0;
  for (std::size_t n = 0; n < first.size(); ++n) {
    if (first[n] != n) continue;
    place[n] = kept;
    mesh.vertices[kept++] = mesh.vertices[n];
  }
  mesh.vertices.resize(kept);
  for (std::uint32_t& index : mesh.indices) index = place[first[index]];
}

}  // namespace

BrickMesh mesh_brick(const DensityView& view, std::size_t brick) {
  return BrickMesher(view).mesh(brick);
}

BrickMesh mesh_in_one_piece(const DensityView& view) {
  BrickMesh whole;
  std::vector<SharedVertex> shared;
  BrickMesher mesher(view);
  const std::size_t bricks = SurfaceBricks(view.grid.geometry().dims).count();
  for (std::size_t brick = 0; brick < bricks; ++brick) {
    const BrickMesh& mesh = mesher.mesh(brick);
    const auto base = static_cast<std::uint32_t>(whole.vertices.size());
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      if (mesher.is_on_brick_border(n))
        shared.push_back({mesher.edge_of(n), base + static_cast<std::uint32_t>(n)});
    }
    whole.vertices.insert(whole.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const std::uint32_t index : mesh.indices) whole.indices.push_back(base + index);
  }
  merge_vertices(whole, first_of_same_edge(whole.vertices.size(), std::move(shared)));
  return whole;
}

}  // namespace osteomill
