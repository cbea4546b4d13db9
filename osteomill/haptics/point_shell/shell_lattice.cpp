#include "osteomill/haptics/point_shell/shell_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/haptics/bone_points/bits_above.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {

namespace {

int& component(VoxelIndex& v, int axis) {
  return axis == 0 ? v.i : axis == 1 ? v.j : v.k;
}

int divide_down(int value, int divisor) {
  const int quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

float largest_float_up_to(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value
             ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
             : nearest;
}

// How far from a bone voxel to a neighbour that is not bone the isosurface lies: density runs linearly along
// an edge of the grid. None of the way where the voxel itself has fallen since it was last looked at, as it
// will be again.
double share_to_surface(double inside, double outside, double isovalue) {
  return inside > isovalue ? (inside - isovalue) / (inside - outside) : 0;
}

// Points nearer to one another say nothing more about a burr of a millimetre, and a tick's cost would grow
// with their number: with the square of how fine the scan is.
constexpr double kFinestCell_mm = 0.0625;

int nodes_of_cell(const ShellRules& rules, const GridGeometry& voxels) {
  const double finest = (1 + 1e-6) * kFinestCell_mm / voxels.spacing_mm.maxCoeff();
  return std::max(rules.scale,
                  static_cast<int>(std::min(finest, static_cast<double>(ShellRules::kMaxScale))));
}

GridGeometry lattice_geometry(const GridGeometry& voxels, int stride) {
  GridGeometry lattice = voxels;
  lattice.origin_mm = voxels.world_from_voxel(Vec3::Constant(0.5 * (stride - 1)).eval());
  lattice.spacing_mm = stride * voxels.spacing_mm;
  for (int& dim : lattice.dims) dim = (dim + stride - 1) / stride;
  return lattice;
}

}  // namespace

ShellLattice::ShellLattice(const Volume& volume, const ShellRules& rules)
    : volume_(&volume),
      rules_(rules),
      stride_(rules.surface_shell ? 1 : rules.scale),
      group_(rules.surface_shell ? nodes_of_cell(rules, volume.geometry()) : 1),
      geometry_(lattice_geometry(volume.geometry(), stride_)),
      cell_area_mm2_(std::pow(volume.geometry().voxel_volume_mm3(), 2.0 / 3.0) * rules.scale * rules.scale),
      face_mm2_(geometry_.voxel_volume_mm3() * geometry_.spacing_mm.cwiseInverse()),
      half_per_mm_(0.5 * geometry_.spacing_mm.cwiseInverse()),
      bone_above_(largest_float_up_to(volume.isovalue())) {}

std::array<int, 3> ShellLattice::cell_dims() const {
  std::array<int, 3> dims = geometry_.dims;
  for (int& dim : dims) dim = (dim + group_ - 1) / group_;
  return dims;
}

double ShellLattice::density(const VoxelIndex& node) const {
  if (stride_ == 1) return static_cast<double>(volume_->grid().at_or_outside(node));
  const Vec3 voxel = stride_ * Vec3(node.i, node.j, node.k) + Vec3::Constant(0.5 * (stride_ - 1));
  return density_at_voxel(volume_->grid(), voxel);
}

std::uint8_t ShellLattice::bone_byte(int byte, int j, int k) const {
  const int first = 8 * byte;
  const int count = std::min(8, geometry_.dims[0] - first);
  unsigned bits = 0;
  if (stride_ == 1) {
    const float* row = volume_->grid().densities().data() + volume_->grid().linear_index({first, j, k});
    if (count == 8) return eight_above(row, bone_above_);
    for (int n = 0; n < count; ++n) bits |= static_cast<unsigned>(row[n] > bone_above_) << n;
  } else {
    for (int n = 0; n < count; ++n) {
      bits |= static_cast<unsigned>(is_bone({first + n, j, k})) << n;
    }
  }
  return static_cast<std::uint8_t>(bits);
}

void ShellLattice::prefetch_rows(const VoxelBox& nodes) const {
  if (stride_ != 1) return;
  for (int k = nodes.first.k; k <= nodes.last.k; ++k) {
    for (int j = nodes.first.j; j <= nodes.last.j; ++j) volume_->grid().prefetch({nodes.first.i, j, k});
  }
}

bool ShellLattice::is_deep_in_bone(int bi, int bj, int bk) const {
  if (stride_ != 1) return false;
  const BlockRanges& bricks = volume_->bricks();
  const auto& dims = bricks.dims();
  const VoxelIndex first{group_ * bi, group_ * bj, group_ * bk};
  const VoxelIndex end{first.i + group_, first.j + group_, first.k + group_};
  if (bi < 1 || bj < 1 || bk < 1 || end.i >= dims[0] || end.j >= dims[1] || end.k >= dims[2]) return false;
  // A brick's range takes the next layer of voxels above in, but not the one below.
  for (int k = first.k - 1; k < end.k; ++k) {
    for (int j = first.j - 1; j < end.j; ++j) {
      for (int i = first.i - 1; i < end.i; ++i) {
        const bool beside = (i < first.i) + (j < first.j) + (k < first.k) <= 1;
        if (beside && !(bricks.at(i, j, k).min > bone_above_)) return false;
      }
    }
  }
  return true;
}

VoxelBox ShellLattice::nodes_touched_by(const VoxelBox& voxels) const {
  if (voxels.empty()) return voxels;
  const int s = stride_;
  // A node lies (s - 1) / 2 voxels into its stride and reads the voxels on both sides of it.
  VoxelBox nodes = voxels;
  if (s > 1) {
    const int before = s / 2, after = (s - 1) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      int& first = component(nodes.first, axis);
      int& last = component(nodes.last, axis);
      first = divide_down(first - before, s);
      last = divide_down(last - after, s) + 1;
    }
  }
  return nodes.intersected(geometry_.all_voxels());
}

ShellPoint ShellLattice::point_of_cell(const BoneBits& bone, const VoxelIndex& cell,
                                       const VoxelIndex& frame_origin) const {
  WeightedSum sum;
  const VoxelIndex first{cell.i * group_, cell.j * group_, cell.k * group_};
  const VoxelIndex last{std::min(first.i + group_, geometry_.dims[0]) - 1,
                        std::min(first.j + group_, geometry_.dims[1]) - 1,
                        std::min(first.k + group_, geometry_.dims[2]) - 1};
  for (int k = first.k; k <= last.k; ++k) {
    for (int j = first.j; j <= last.j; ++j) {
      for (int i = first.i; i <= last.i; ++i) {
        if (bone.is_bone(i, j, k)) add_node(bone, {i, j, k}, frame_origin, sum);
      }
    }
  }
  const Vec3 mean_mm = (1 / sum.weight) * sum.position_mm;
  const double length = sum.normal.norm();
  const Vec3 normal = length > 1e-9 ? Vec3((1 / length) * sum.normal) : Vec3(Vec3::Zero());
  return {
      static_cast<float>(mean_mm.x()), static_cast<float>(mean_mm.y()),
      static_cast<float>(mean_mm.z()), static_cast<float>(rules_.surface_shell ? sum.weight : cell_area_mm2_),
      static_cast<float>(normal.x()),  static_cast<float>(normal.y()),
      static_cast<float>(normal.z())};
}

// Adds the faces between a bone node and its neighbours that are not bone.
void ShellLattice::add_node(const BoneBits& bone, const VoxelIndex& node, const VoxelIndex& frame_origin,
                            WeightedSum& sum) const {
  if (is_inner_voxel(node)) {
    add_inner_voxel(node, frame_origin, sum);
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      VoxelIndex outer = node;
      component(outer, axis) += side;
      if (bone.is_bone(outer.i, outer.j, outer.k)) continue;
      Face face{axis, side};
      if (rules_.surface_shell) {
        face.fraction = crossing_fraction(density(node), outer);
        weigh_by_area(face, gradient_on_edge(node, axis, side * face.fraction));
      }
      add_face(face, node, frame_origin, sum);
    }
  }
}

void ShellLattice::add_face(const Face& face, const VoxelIndex& node, const VoxelIndex& frame_origin,
                            WeightedSum& sum) const {
  Vec3 at(node.i - frame_origin.i, node.j - frame_origin.j, node.k - frame_origin.k);
  if (rules_.surface_shell) at[face.axis] += face.side * face.fraction;
  sum.position_mm += face.weight * geometry_.spacing_mm.cwiseProduct(at);
  sum.normal += face.weight * face.normal_G;
  sum.weight += face.weight;
}

// Whether the shorter way below serves: a voxel with all that it needs inside the grid.
bool ShellLattice::is_inner_voxel(const VoxelIndex& node) const {
  return stride_ == 1 && node.i >= 2 && node.j >= 2 && node.k >= 2 && node.i < geometry_.dims[0] - 2 &&
         node.j < geometry_.dims[1] - 2 && node.k < geometry_.dims[2] - 2;
}

// The same as the rest of `add_node`, straight from the voxels: milling calls this hundreds of times a tick.
void ShellLattice::add_inner_voxel(const VoxelIndex& voxel, const VoxelIndex& frame_origin,
                                   WeightedSum& sum) const {
  const DensityGrid& grid = volume_->grid();
  const float* here = grid.densities().data() + grid.linear_index(voxel);
  const std::ptrdiff_t row = geometry_.dims[0];
  const std::ptrdiff_t next[3] = {1, row, row * geometry_.dims[1]};
  const auto gradient_at = [&](const float* at) {
    return Vec3(static_cast<double>(at[next[0]] - at[-next[0]]) * half_per_mm_[0],
                static_cast<double>(at[next[1]] - at[-next[1]]) * half_per_mm_[1],
                static_cast<double>(at[next[2]] - at[-next[2]]) * half_per_mm_[2]);
  };
  const Vec3 gradient_here = rules_.surface_shell ? gradient_at(here) : Vec3(Vec3::Zero());
  const double inside = static_cast<double>(*here);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const float* outer = here + side * next[axis];
      if (*outer > bone_above_) continue;
      Face face{axis, side, share_to_surface(inside, static_cast<double>(*outer), volume_->isovalue())};
      if (rules_.surface_shell) {
        weigh_by_area(face, (1 - face.fraction) * gradient_here + face.fraction * gradient_at(outer));
      }
      add_face(face, voxel, frame_origin, sum);
    }
  }
}

double ShellLattice::crossing_fraction(double inside, const VoxelIndex& outer_node) const {
  const double outside = density(outer_node);
  const double iso = volume_->isovalue();
  // Beyond the border the outside density may be bone's: the surface is then the border voxel's face.
  return outside <= iso ? share_to_surface(inside, outside, iso) : 0.5;
}

Vec3 ShellLattice::gradient_on_edge(const VoxelIndex& node, int axis, double offset) const {
  Vec3 at(node.i, node.j, node.k);
  at[axis] += offset;
  return geometry_.direction.transpose() *
         density_gradient(volume_->grid(), geometry_.world_from_voxel(at), GradientKernel::central);
}

// A face counts for its area seen along the surface's normal n, A_a |n_a|: over a plane that adds up to
// A (n_x^2 + n_y^2 + n_z^2), its true area whatever its slope, and an error of the normal enters only with
// its square.
void ShellLattice::weigh_by_area(Face& face, const Vec3& gradient_G) const {
  const double steepness = gradient_G.norm();
  if (steepness > 0) face.normal_G = (-1 / steepness) * gradient_G;
  // Never quite nothing, so that a point's mean has a weight to divide by.
  const double seen = steepness > 0 ? std::max(1e-6, std::abs(face.normal_G[face.axis])) : 1.0;
  face.weight = face_mm2_[face.axis] * seen;
}

}  // namespace osteomill::point_shell
