#include "osteomill/surface/brick_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace osteomill {

namespace {

using Index = std::uint32_t;

struct Edge {
  Index from;
  Index to;
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

// Takes the vertices of one brick together, level by level.
class Coarsening {
 public:
  Coarsening(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells)
      : mesh_(mesh), cluster_(mesh.vertices.size()), parent_(cluster_.size()), triangles_(mesh.indices) {
    const Vec3 first(cells.first.i, cells.first.j, cells.first.k);
    const Vec3 last(cells.last.i + 1, cells.last.j + 1, cells.last.k + 1);
    voxels_.reserve(cluster_.size());
    faces_.reserve(cluster_.size());
    for (const MeshVertex& vertex : mesh.vertices) {
      const auto& p = vertex.position_mm;
      const Vec3 voxel = geometry.voxel_from_world({p[0], p[1], p[2]});
      unsigned faces = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(voxel[axis] - first[axis]) < kOnFace_voxels) faces |= 1u << (2 * axis);
        if (std::abs(voxel[axis] - last[axis]) < kOnFace_voxels) faces |= 2u << (2 * axis);
      }
      voxels_.push_back(voxel);
      faces_.push_back(faces);
    }
    std::iota(cluster_.begin(), cluster_.end(), Index{0});
    order_ = cluster_;
    std::sort(order_.begin(), order_.end(),
              [&](Index a, Index b) { return mesh.vertices[a].position_mm < mesh.vertices[b].position_mm; });
    border_ = border_edges();
  }

  // Cells of `size` voxels.
  void take_together(int size) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
    const auto join = [&](const Edge& edge) {
      if (same_cell(edge.from, edge.to, size)) parent_[root(edge.from)] = root(edge.to);
    };
    for_edges([&](const Edge& edge) {
      if (faces_[edge.from] == 0 && faces_[edge.to] == 0) join(edge);
    });
    // The border's own edges alone say what belongs together on it: both bricks have the same.
    for (const Edge& edge : border_edges()) {
      if (faces_[edge.from] == faces_[edge.to] && std::has_single_bit(faces_[edge.from])) join(edge);
    }
    for (Index& cluster : cluster_) cluster = root(cluster);
    std::size_t left = 0;
    for (std::size_t n = 0; n < triangles_.size(); n += 3) {
      std::array<Index, 3> corners{};
      for (std::size_t corner = 0; corner < 3; ++corner) corners[corner] = cluster_[triangles_[n + corner]];
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      std::copy(corners.begin(), corners.end(), triangles_.begin() + static_cast<std::ptrdiff_t>(left));
      left += 3;
    }
    triangles_.resize(left);
  }

  // Adds the level's vertices, triangles and seams.
  void add_level(BrickLevels& result, std::size_t level) {
    add_means(result.vertices);
    const auto begin = [&](BrickLevels::Range& range) { range.first = result.indices.size(); };
    const auto end = [&](BrickLevels::Range& range) { range.count = result.indices.size() - range.first; };
    begin(result.levels[level]);
    for (const Index corner : triangles_) result.indices.push_back(mean_[corner]);
    end(result.levels[level]);
    for (std::size_t face = 0; face < BrickLevels::kFaces; ++face) {
      begin(result.seams[level][face]);
      add_seam(face, result.indices);
      end(result.seams[level][face]);
    }
  }

 private:
  static constexpr double kOnFace_voxels = 1e-3;

  template <typename Use>
  void for_edges(const Use& use) const {
    for (std::size_t n = 0; n < triangles_.size(); n += 3) {
      for (std::size_t corner = 0; corner < 3; ++corner)
        use(Edge{triangles_[n + corner], triangles_[n + (corner + 1) % 3]});
    }
  }

  // Those in a face of the brick that no other triangle of the brick has.
  std::vector<Edge> border_edges() const {
    std::vector<Edge> edges;
    for_edges([&](const Edge& edge) {
      if ((faces_[edge.from] & faces_[edge.to]) != 0) edges.push_back(edge);
    });
    std::sort(edges.begin(), edges.end());
    std::vector<Edge> alone;
    for (const Edge& edge : edges) {
      if (!std::binary_search(edges.begin(), edges.end(), Edge{edge.to, edge.from})) alone.push_back(edge);
    }
    return alone;
  }

  Index root(Index vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

  // Half a voxel off, since two of a vertex's three coordinates are whole numbers.
  static double cell_of(double voxel, int size) { return std::floor((voxel + 0.5) / size); }

  bool same_cell(Index a, Index b, int size) const {
    for (int axis = 0; axis < 3; ++axis) {
      if ((faces_[a] >> (2 * axis) & 3u) != 0) continue;
      if (cell_of(voxels_[a][axis], size) != cell_of(voxels_[b][axis], size)) return false;
    }
    return true;
  }

  // The mean of each cluster as a vertex of its own; one that is alone stays the mesh's own. Added up in an
  // order that is the same in all bricks that share the vertices.
  void add_means(std::vector<MeshVertex>& means) {
    struct Sum {
      std::array<double, 7> of{};
      int count = 0;
    };
    std::vector<Sum> sums(cluster_.size());
    for (const Index vertex : order_) {
      Sum& sum = sums[cluster_[vertex]];
      const MeshVertex& v = mesh_.vertices[vertex];
      for (std::size_t n = 0; n < 3; ++n) {
        sum.of[n] += static_cast<double>(v.position_mm[n]);
        sum.of[3 + n] += static_cast<double>(v.normal[n]);
      }
      sum.of[6] += static_cast<double>(v.density);
      ++sum.count;
    }
    mean_ = cluster_;
    std::vector<Index> place(cluster_.size(), 0);
    for (Index vertex = 0; vertex < sums.size(); ++vertex) {
      const Sum& sum = sums[vertex];
      if (sum.count < 2) continue;
      place[vertex] = static_cast<Index>(mesh_.vertices.size() + means.size());
      MeshVertex mean = mesh_.vertices[vertex];
      const double length = std::hypot(sum.of[3], sum.of[4], sum.of[5]);
      for (std::size_t n = 0; n < 3; ++n) {
        mean.position_mm[n] = static_cast<float>(sum.of[n] / sum.count);
        if (length > 1e-3) mean.normal[n] = static_cast<float>(sum.of[3 + n] / length);
      }
      mean.density = static_cast<float>(sum.of[6] / sum.count);
      means.push_back(mean);
    }
    for (Index& mean : mean_) {
      if (place[mean] != 0) mean = place[mean];
    }
  }

  void add_seam(std::size_t face, std::vector<Index>& indices) const {
    const auto add = [&](Index a, Index b, Index c) {
      if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c, a, c, b});
    };
    for (const Edge& edge : border_) {
      if ((faces_[edge.from] & faces_[edge.to] & 1u << face) == 0) continue;
      add(edge.from, edge.to, mean_[edge.to]);
      add(edge.from, mean_[edge.to], mean_[edge.from]);
    }
  }

  const BrickMesh& mesh_;
  std::vector<Vec3> voxels_;
  std::vector<unsigned> faces_;  // a bit for each face of the brick on which the vertex lies
  std::vector<Index> order_;
  std::vector<Index> cluster_;  // by vertex: one that stands for all that are together
  std::vector<Index> parent_;   // of what is taken together in this step
  std::vector<Index> mean_;     // by vertex: where the mean of its cluster is
  std::vector<Index> triangles_;
  std::vector<Edge> border_;
};

}  // namespace

BrickLevels full_detail(const BrickMesh& mesh) {
  BrickLevels result;
  result.indices = mesh.indices;
  result.levels.fill({0, mesh.indices.size()});
  return result;
}

BrickLevels levels_of(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells) {
  BrickLevels result = full_detail(mesh);
  if (mesh.empty()) return result;
  Coarsening coarsening(mesh, geometry, cells);
  for (std::size_t level = 1; level < BrickLevels::kCount; ++level) {
    coarsening.take_together(1 << level);
    coarsening.add_level(result, level);
  }
  return result;
}

}  // namespace osteomill
