#include "surface/brick_mesher.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "osteomill/base/bits_above.h"

#include "surface/cube_cases.h"

namespace osteomill {

namespace {

// Minimum distance of vertices from voxel centres, as a fraction of the edge. Without it, if a density equals
// the isovalue, the vertices around that voxel would coincide and their triangles degenerate.
constexpr float kMinShare = 1.0f / 512;

// Returns the squared norm, summed in component order, unlike Eigen's.
float squared(const Eigen::Vector3f& v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

// Mask of bits `first` to `last`.
constexpr std::uint32_t bit_span(int first, int last) {
  return ((2u << last) - 1u) & ~((1u << first) - 1u);
}

}  // namespace

BrickMesher::BrickMesher(const DensityView& view)
    : view_(view),
      layout_(view.grid.geometry().dims),
      threshold_(largest_float_up_to(view.isovalue)),
      outside_(std::min(view.grid.outside_density(), threshold_)),
      mirrored_(view.grid.geometry().direction.determinant() < 0) {
  const GridGeometry& geometry = view.grid.geometry();
  origin_mm_ = geometry.origin_mm;
  step_mm_ = geometry.direction * geometry.spacing_mm.asDiagonal();
  normal_of_ =
      -(geometry.direction.array().rowwise() / geometry.spacing_mm.transpose().array()).cast<float>();
  for (int edge = 0; edge < 12; ++edge) {
    const int axis = edge / 4;
    const int u = axis == 0 ? 1 : 0;
    const int v = axis == 2 ? 1 : 2;
    edge_offset_[static_cast<std::size_t>(edge)] = axis * kBlockVoxels +
                                                   (edge & 1) * kStride[static_cast<std::size_t>(u)] +
                                                   (edge >> 1 & 1) * kStride[static_cast<std::size_t>(v)];
  }
  bone_.fill(0);
}

bool BrickMesher::can_hold_surface(std::size_t brick) const {
  constexpr int kRange = BlockRanges::kBrickVoxels;
  const VoxelBox cells = layout_.cells(brick);
  const std::array<int, 3>& dims = view_.ranges.dims();
  const auto at_border = [](int b, int count) { return b == 0 || b == count - 1; };
  for (int bk = std::max(cells.first.k, 0) / kRange; bk <= cells.last.k / kRange; ++bk) {
    for (int bj = std::max(cells.first.j, 0) / kRange; bj <= cells.last.j / kRange; ++bj) {
      for (int bi = std::max(cells.first.i, 0) / kRange; bi <= cells.last.i / kRange; ++bi) {
        const BlockRanges::Range& range = view_.ranges.at(bi, bj, bk);
        if (range.max <= threshold_) continue;
        if (range.min <= threshold_ || at_border(bi, dims[0]) || at_border(bj, dims[1]) ||
            at_border(bk, dims[2])) {
          return true;
        }
      }
    }
  }
  return false;
}

const BrickMesh& BrickMesher::mesh(std::size_t brick) {
  mesh_.vertices.clear();
  vertex_edge_.clear();
  mesh_.indices.clear();
  if (!can_hold_surface(brick)) return mesh_;
  load(brick);
  find_bone();
  const auto rows = rows_with_surface();
  if (!rows) return mesh_;
  smooth(*rows);
  add_vertices();
  add_triangles();
  return mesh_;
}

void BrickMesher::load(std::size_t brick) {
  const auto [bi, bj, bk] = layout_.coordinates(brick);
  constexpr int kCells = SurfaceBricks::kBrickCells;
  corner_ = {bi * kCells - kLow, bj * kCells - kLow, bk * kCells - kLow};
  const VoxelBox cells = layout_.cells(brick);
  cells_ = {{cells.first.i - corner_.i, cells.first.j - corner_.j, cells.first.k - corner_.k},
            {cells.last.i - corner_.i, cells.last.j - corner_.j, cells.last.k - corner_.k}};
  // From two voxels before the cells to two beyond their upper corners.
  for (int k = cells_.first.k - 2; k <= cells_.last.k + 3; ++k) {
    for (int j = cells_.first.j - 2; j <= cells_.last.j + 3; ++j) {
      load_row({corner_.i, corner_.j + j, corner_.k + k},
               &block_[static_cast<std::size_t>(j * kStride[1] + k * kStride[2])]);
    }
  }
}

void BrickMesher::load_row(const VoxelIndex& first, float* row) const {
  const std::array<int, 3>& dims = view_.grid.geometry().dims;
  if (first.j < 0 || first.j >= dims[1] || first.k < 0 || first.k >= dims[2]) {
    std::fill_n(row, kBlock, outside_);
    return;
  }
  const float* stored = view_.grid.row(first.j, first.k).data();
  if (first.i >= 0 && first.i + kBlock <= dims[0]) {
    std::copy_n(stored + first.i, kBlock, row);
    return;
  }
  for (int n = 0; n < kBlock; ++n) {
    const int i = first.i + n;
    row[n] = i >= 0 && i < dims[0] ? stored[i] : outside_;
  }
}

void BrickMesher::find_bone() {
  for (int k = cells_.first.k; k <= cells_.last.k + 1; ++k) {
    for (int j = cells_.first.j; j <= cells_.last.j + 1; ++j) {
      const auto row = static_cast<std::size_t>(j + k * kBlock);
      bone_[row] = bits_above(&block_[row * kBlock], kBlock, threshold_);
    }
  }
}

// Returns the range of rows that contain or enclose a crossing of the isovalue.
std::optional<RowBox> BrickMesher::rows_with_surface() const {
  RowBox rows{kBlock, -1, kBlock, -1};
  const std::uint32_t voxels = bit_span(cells_.first.i, cells_.last.i + 1);
  for (int k = cells_.first.k; k <= cells_.last.k; ++k) {
    for (int j = cells_.first.j; j <= cells_.last.j; ++j) {
      const std::uint32_t* row = &bone_[static_cast<std::size_t>(j + k * kBlock)];
      const std::uint32_t any = (row[0] | row[1] | row[kBlock] | row[kBlock + 1]) & voxels;
      const std::uint32_t all = row[0] & row[1] & row[kBlock] & row[kBlock + 1] & voxels;
      if (any == 0 || all == voxels) continue;
      rows = {std::min(rows.first_j, j), std::max(rows.last_j, j + 1), std::min(rows.first_k, k), k + 1};
    }
  }
  if (rows.last_j < 0) return std::nullopt;
  return rows;
}

// Computes the sums that vertices in these rows need.
void BrickMesher::smooth(const RowBox& rows) {
  const RowBox around{rows.first_j - 1, rows.last_j + 1, rows.first_k - 1, rows.last_k + 1};
  smooth_rows<kBlock>(
      block_.data(), around, [](const auto& row) -> const auto& { return row; }, smooth_.data());
  const auto excess = [&](const auto& row) { return (row - threshold_).cwiseMax(0.0f); };
  smooth_rows<kBlock>(block_.data(), around, excess, excess_.data());
  smooth_rows<kBlock>(
      block_.data(), around, [&](const auto& row) { return excess(row).square(); }, excess2_.data());
}

void BrickMesher::add_vertices() {
  const std::uint32_t cells = bit_span(cells_.first.i, cells_.last.i);
  const std::uint32_t voxels = bit_span(cells_.first.i, cells_.last.i + 1);
  for (int k = cells_.first.k; k <= cells_.last.k + 1; ++k) {
    for (int j = cells_.first.j; j <= cells_.last.j + 1; ++j) {
      const auto row = static_cast<std::size_t>(j + k * kBlock);
      const std::uint32_t bone = bone_[row];
      add_row_vertices<0>(j, k, (bone ^ bone >> 1) & cells);
      if (j <= cells_.last.j) add_row_vertices<1>(j, k, (bone ^ bone_[row + 1]) & voxels);
      if (k <= cells_.last.k) add_row_vertices<2>(j, k, (bone ^ bone_[row + kBlock]) & voxels);
    }
  }
}

template <int axis>
void BrickMesher::add_row_vertices(int j, int k, std::uint32_t crossed) {
  for (; crossed != 0; crossed &= crossed - 1) add_vertex<axis>(std::countr_zero(crossed), j, k);
}

template <int axis>
void BrickMesher::add_vertex(int i, int j, int k) {
  constexpr int kAlong = kStride[axis];
  const int place = i + j * kStride[1] + k * kStride[2];
  const float* at = block_.data() + place;
  const bool bone_first = at[0] > threshold_;
  // If density differences overflow, the quotient is NaN, and max returns its first argument.
  const float share =
      std::min(std::max(kMinShare, (threshold_ - at[0]) / (at[kAlong] - at[0])), 1 - kMinShare);

  const int edge = axis * kBlockVoxels + place;
  edge_vertex_[static_cast<std::size_t>(edge)] = static_cast<std::uint16_t>(mesh_.vertices.size());
  vertex_edge_.push_back(static_cast<std::uint32_t>(edge));
  Vec3 voxel(corner_.i + i, corner_.j + j, corner_.k + k);
  voxel[axis] += static_cast<double>(share);
  Vec3f in_block = Eigen::Vector3i(i, j, k).cast<float>();
  in_block[axis] += share;
  const float* smooth = smooth_.data() + place;
  const Vec3f slope = slope_between(smooth, smooth + kAlong, share);
  const Vec3f position_mm = position_at(voxel), normal = normal_against(slope, axis, bone_first);
  const float bone = bone_first ? at[0] : at[kAlong];
  mesh_.vertices.push_back({{position_mm[0], position_mm[1], position_mm[2]},
                            {normal[0], normal[1], normal[2]},
                            density_below(in_block, slope, bone)});
}

// Returns the density of the bone around the point one voxel down the slope from a point of the block: the
// mean, weighted by each voxel's excess over the threshold, so that air or partial air counts little; `flat`
// if the slope is zero.
float BrickMesher::density_below(const Vec3f& point, const Vec3f& slope, float flat) const {
  const float steepness = std::sqrt(squared(slope));
  if (!(steepness > 0 && std::isfinite(steepness))) return flat;
  // A full voxel could reach beyond the last smoothed layer.
  const Vec3f here = point + 0.999f / steepness * slope;
  const Eigen::Vector3i cell = here.cast<int>();
  const Vec3f fraction = here - cell.cast<float>();
  const int corner = cell[0] + cell[1] * kStride[1] + cell[2] * kStride[2];
  const auto at_place = [&](const float* first) {
    const auto along = [](float a, float b, float share) { return a + share * (b - a); };
    const auto row = [&](const float* at) { return along(at[0], at[1], fraction[0]); };
    const auto layer = [&](const float* at) { return along(row(at), row(at + kStride[1]), fraction[1]); };
    return along(layer(first + corner), layer(first + corner + kStride[2]), fraction[2]);
  };
  const float mean = at_place(excess2_.data()) / at_place(excess_.data());
  return std::isfinite(mean) ? threshold_ + mean : flat;
}

// Returns the smoothed slope between two adjacent voxels, unscaled: central differences, averaged over
// neighbours with weights 1, 4, 1, which minimizes the dependence on grid orientation.
BrickMesher::Vec3f BrickMesher::slope_between(const float* from, const float* to, float share) {
  const auto at = [&](int offset) { return from[offset] + share * (to[offset] - from[offset]); };
  Vec3f slope;
  for (int axis = 0; axis < 3; ++axis) {
    const int along = kStride[static_cast<std::size_t>(axis)];
    const auto difference = [&](int offset) { return at(offset + along) - at(offset - along); };
    slope[axis] = 2 * difference(0);
    for (int other = 0; other < 3; ++other) {
      const int across = kStride[static_cast<std::size_t>(other)];
      if (other != axis) slope[axis] += difference(across) + difference(-across);
    }
  }
  return slope;
}

BrickMesher::Vec3f BrickMesher::position_at(const Vec3& voxel) const {
  return (origin_mm_ + step_mm_.col(0) * voxel[0] + step_mm_.col(1) * voxel[1] + step_mm_.col(2) * voxel[2])
      .cast<float>();
}

BrickMesher::Vec3f BrickMesher::normal_against(const Vec3f& slope, int axis, bool bone_first) const {
  Vec3f normal = normal_of_.col(0) * slope[0] + normal_of_.col(1) * slope[1] + normal_of_.col(2) * slope[2];
  float length2 = squared(normal);
  if (!(length2 > 0 && std::isfinite(length2))) {
    // Constant density: use the edge direction out of the bone.
    normal = (bone_first ? -1.0f : 1.0f) * normal_of_.col(axis);
    length2 = squared(normal);
  }
  return 1 / std::sqrt(length2) * normal;
}

void BrickMesher::add_triangles() {
  for (int k = cells_.first.k; k <= cells_.last.k; ++k) {
    for (int j = cells_.first.j; j <= cells_.last.j; ++j) add_row_triangles(j, k);
  }
}

void BrickMesher::add_row_triangles(int j, int k) {
  const auto row = static_cast<std::size_t>(j + k * kBlock);
  const std::uint32_t near_low = bone_[row];
  const std::uint32_t near_high = bone_[row + 1];
  const std::uint32_t far_low = bone_[row + kBlock];
  const std::uint32_t far_high = bone_[row + kBlock + 1];
  const std::uint32_t any = near_low | near_high | far_low | far_high;
  const std::uint32_t all = near_low & near_high & far_low & far_high;
  std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & bit_span(cells_.first.i, cells_.last.i);
  for (; mixed != 0; mixed &= mixed - 1) {
    const int i = std::countr_zero(mixed);
    const std::uint32_t bone =
        (near_low >> i & 3) | (near_high >> i & 3) << 2 | (far_low >> i & 3) << 4 | (far_high >> i & 3) << 6;
    const CubeCase& cube = kCubeCases[bone];
    const std::uint16_t* edge_vertex = edge_vertex_.data() + i + row * kBlock;
    std::array<std::uint32_t, 15> corners;
    for (std::size_t n = 0; n < cube.edge_count; ++n) {
      corners[n] = edge_vertex[edge_offset_[cube.edges[n]]];
    }
    if (mirrored_) {
      for (std::size_t n = 0; n < cube.edge_count; n += 3) std::swap(corners[n], corners[n + 1]);
    }
    mesh_.indices.insert(mesh_.indices.end(), corners.begin(), corners.begin() + cube.edge_count);
  }
}

std::uint64_t BrickMesher::edge_of(std::size_t vertex) const {
  const auto edge = static_cast<int>(vertex_edge_[vertex]);
  const int place = edge % kBlockVoxels;
  const std::array<int, 3>& dims = view_.grid.geometry().dims;
  // Voxel indices plus one, because an edge may begin before voxel 0.
  const auto i = static_cast<std::uint64_t>(corner_.i + place % kBlock + 1);
  const auto j = static_cast<std::uint64_t>(corner_.j + place / kBlock % kBlock + 1);
  const auto k = static_cast<std::uint64_t>(corner_.k + place / kStride[2] + 1);
  const auto columns = static_cast<std::uint64_t>(dims[0] + 2);
  const auto rows = static_cast<std::uint64_t>(dims[1] + 2);
  return 3 * (i + columns * (j + rows * k)) + static_cast<std::uint64_t>(edge / kBlockVoxels);
}

bool BrickMesher::is_on_brick_border(std::size_t vertex) const {
  const auto edge = static_cast<int>(vertex_edge_[vertex]);
  const int place = edge % kBlockVoxels;
  const std::array<int, 3> at{place % kBlock, place / kBlock % kBlock, place / kStride[2]};
  for (int axis = 0; axis < 3; ++axis) {
    const int within = at[static_cast<std::size_t>(axis)] - kLow;
    if (axis != edge / kBlockVoxels && (within == 0 || within == SurfaceBricks::kBrickCells)) return true;
  }
  return false;
}

}  // namespace osteomill
