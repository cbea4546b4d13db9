#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "osteomill/visual/brick_mesh.h"
#include "osteomill/visual/surface_bricks.h"
#include "osteomill/visual/surface_mesh.h"

#include "surface/smoothed_rows.h"

namespace osteomill {

/// Meshes bricks one after the other in the same memory. Copies each brick's densities with a margin into a
/// block first, so that meshing stays in the cache and needs no border cases.
class BrickMesher {
 public:
  explicit BrickMesher(const DensityView& view);

  /// Returns the brick's surface; valid until the next call.
  const BrickMesh& mesh(std::size_t brick);

  /// Returns the number of the grid edge on which a vertex lies, unique in the grid and the same in all
  /// bricks.
  std::uint64_t edge_of(std::size_t vertex) const;
  /// Returns whether other bricks may share this vertex.
  bool is_on_brick_border(std::size_t vertex) const;

 private:
  using Vec3f = Eigen::Vector3f;

  // Voxels along each edge of the block: those of the cells, and the margin for smoothed gradients and
  // densities; a multiple of 4.
  static constexpr int kLow = 4;  // the block's index of the brick's first voxel
  static constexpr int kBlock = SurfaceBricks::kBrickCells + 8;
  static constexpr std::array<int, 3> kStride{1, kBlock, kBlock* kBlock};
  static constexpr int kBlockVoxels = kBlock * kBlock * kBlock;
  static_assert(kBlock <= 32, "a row of the block is a word of bits");

  bool can_hold_surface(std::size_t brick) const;
  void load(std::size_t brick);
  void load_row(const VoxelIndex& first, float* row) const;
  void find_bone();
  std::optional<RowBox> rows_with_surface() const;
  void smooth(const RowBox& rows);
  void add_vertices();
  template <int axis>
  void add_row_vertices(int j, int k, std::uint32_t crossed);
  template <int axis>
  void add_vertex(int i, int j, int k);
  float density_below(const Vec3f& point, const Vec3f& slope, float flat) const;
  static Vec3f slope_between(const float* from, const float* to, float share);
  Vec3f position_at(const Vec3& voxel) const;
  Vec3f normal_against(const Vec3f& slope, int axis, bool bone_first) const;
  void add_triangles();
  void add_row_triangles(int j, int k);

  DensityView view_;
  SurfaceBricks layout_;
  float threshold_;  // the greatest float that is not bone
  float outside_;
  bool mirrored_;  // the grid's axes are left-handed
  Vec3 origin_mm_;
  Mat3 step_mm_;                     // to the next voxel along each axis, a column each
  Eigen::Matrix3f normal_of_;        // outward, of a density falling along each axis
  std::array<int, 12> edge_offset_;  // of a cube's edges in edge_vertex_

  VoxelIndex corner_;  // the voxel at the block's first index
  VoxelBox cells_;     // in the block's indices
  std::array<float, kBlockVoxels> block_;
  // Weighted sums around each voxel (smooth_rows): of the densities, of their excess over the threshold, and
  // of its square.
  std::array<float, kBlockVoxels> smooth_;
  std::array<float, kBlockVoxels> excess_;
  std::array<float, kBlockVoxels> excess2_;
  std::array<std::uint32_t, kBlock * kBlock> bone_;  // a bit a voxel, a word a row
  std::array<std::uint16_t, 3 * kBlockVoxels> edge_vertex_;
  BrickMesh mesh_;
  std::vector<std::uint32_t> vertex_edge_;  // by vertex
};

}  // namespace osteomill
