#include "osteomill/visual/brick_levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

namespace osteomill {

namespace {

using Index = std::uint32_t;

// Clusters the vertices of a brick, level by level.
class Coarsening {
 public:
  Coarsening(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells)
      : mesh_(mesh),
        min_spacing_mm_(geometry.spacing_mm.minCoeff()),
        cluster_(mesh.vertices.size()),
        parent_(cluster_.size()),
        triangles_(mesh.indices) {
    constexpr double kOnFace_voxels = 1e-3;
    const Vec3 first(cells.first.i, cells.first.j, cells.first.k);
    const Vec3 last(cells.last.i + 1, cells.last.j + 1, cells.last.k + 1);
    for (const MeshVertex& vertex : mesh.vertices) {
      const Vec3 voxel = geometry.voxel_from_world(vec3_of(vertex.position_mm));
      voxels_.push_back(voxel);
      on_border_.push_back((voxel - first).minCoeff() < kOnFace_voxels ||
                           (last - voxel).minCoeff() < kOnFace_voxels);
    }
    std::iota(cluster_.begin(), cluster_.end(), Index{0});
  }

  // Merges connected vertices within cells of `size` voxels.
  void cluster_within(int size) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
    for (std::size_t n = 0; n < triangles_.size(); n += 3) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Index from = triangles_[n + corner], to = triangles_[n + (corner + 1) % 3];
        if (!on_border_[from] && !on_border_[to] && same_cell(from, to, size)) parent_[root(from)] = root(to);
      }
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

  // Adds the level's vertices and triangles.
  void add_level(BrickLevels& result, std::size_t level) {
    add_means(result.vertices, static_cast<double>(1 << level) * min_spacing_mm_);
    result.levels[level] = {result.indices.size(), triangles_.size()};
    for (const Index corner : triangles_) result.indices.push_back(mean_[corner]);
  }

 private:
  Index root(Index vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

  // Returns the cell of a coordinate. The offset of half a voxel avoids ties, because two of a vertex's three
  // coordinates are integers.
  static double cell_of(double voxel, int size) { return std::floor((voxel + 0.5) / size); }

  bool same_cell(Index a, Index b, int size) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (cell_of(voxels_[a][axis], size) != cell_of(voxels_[b][axis], size)) return false;
    }
    return true;
  }

  // Planes of a cluster's triangles, weighted by area: the normal equations of the point with the least
  // squared distances to them.
  struct Planes {
    Mat3 normals = Mat3::Zero();
    Vec3 offsets = Vec3::Zero();

    // Returns the point nearest to all planes; where they leave it undetermined, the one nearest to
    // `point_W`, the mean of the vertices. The mean alone would lie below a sharp edge.
    Vec3 intersection_near(const Vec3& point_W, double reach_mm) const {
      constexpr double kHeld = 0.004;
      const Mat3 held = normals + kHeld * normals.trace() * Mat3::Identity();
      const Vec3 correction = held.ldlt().solve(offsets - normals * point_W);
      return correction.norm() <= reach_mm ? Vec3(point_W + correction) : point_W;
    }
  };

  std::vector<Planes> planes() const {
    std::vector<Planes> result(cluster_.size());
    for (std::size_t n = 0; n < mesh_.indices.size(); n += 3) {
      const Index* corners = &mesh_.indices[n];
      const auto place = [&](int corner) { return vec3_of(mesh_.vertices[corners[corner]].position_mm); };
      const Vec3 twice_area = (place(1) - place(0)).cross(place(2) - place(0));
      const double area = twice_area.norm();
      if (!(area > 0)) continue;
      for (int corner = 0; corner < 3; ++corner) {
        Planes& of = result[cluster_[corners[corner]]];
        of.normals += twice_area * twice_area.transpose() / area;
        of.offsets += twice_area.dot(place(0)) / area * twice_area;
      }
    }
    return result;
  }

  // Adds one vertex per cluster, at the intersection of its planes, with the mean of its normals and
  // densities; a cluster of one vertex keeps the mesh's own.
  void add_means(std::vector<MeshVertex>& vertices, double reach_mm) {
    struct Sum {
      Vec3 positions_mm = Vec3::Zero();
      Vec3 normals = Vec3::Zero();
      double densities = 0;
      int count = 0;
    };
    std::vector<Sum> sums(cluster_.size());
    const std::vector<Planes> planes_of = planes();
    for (Index vertex = 0; vertex < sums.size(); ++vertex) {
      Sum& sum = sums[cluster_[vertex]];
      const MeshVertex& v = mesh_.vertices[vertex];
      sum.positions_mm += vec3_of(v.position_mm);
      sum.normals += vec3_of(v.normal);
      sum.densities += static_cast<double>(v.density);
      ++sum.count;
    }
    mean_ = cluster_;
    std::vector<Index> place(cluster_.size(), 0);
    for (Index vertex = 0; vertex < sums.size(); ++vertex) {
      const Sum& sum = sums[vertex];
      if (sum.count < 2) continue;
      place[vertex] = static_cast<Index>(vertices.size());
      MeshVertex mean = mesh_.vertices[vertex];
      put(planes_of[vertex].intersection_near(sum.positions_mm / sum.count, reach_mm), mean.position_mm);
      if (sum.normals.norm() > 1e-3) put(sum.normals.normalized(), mean.normal);
      mean.density = static_cast<float>(sum.densities / sum.count);
      vertices.push_back(mean);
    }
    for (Index& mean : mean_) {
      if (place[mean] != 0) mean = place[mean];
    }
  }

  const BrickMesh& mesh_;
  double min_spacing_mm_;
  std::vector<Vec3> voxels_;
  std::vector<bool> on_border_;
  std::vector<Index> cluster_;  // by vertex: the vertex that stands for its cluster
  std::vector<Index> parent_;   // union-find of the level that is being made
  std::vector<Index> mean_;     // by vertex: the number of its cluster's mean
  std::vector<Index> triangles_;
};

}  // namespace

BrickLevels full_detail(BrickMesh mesh) {
  BrickLevels result{std::move(mesh.vertices), std::move(mesh.indices)};
  result.levels.fill({0, result.indices.size()});
  return result;
}

BrickLevels build_levels(const BrickMesh& mesh, const GridGeometry& geometry, const VoxelBox& cells) {
  BrickLevels result = full_detail(mesh);
  if (mesh.empty()) return result;
  Coarsening coarsening(mesh, geometry, cells);
  for (std::size_t level = 1; level < BrickLevels::kCount; ++level) {
    coarsening.cluster_within(1 << level);
    coarsening.add_level(result, level);
  }
  return result;
}

}  // namespace osteomill
