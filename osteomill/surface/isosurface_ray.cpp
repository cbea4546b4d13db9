#include "osteomill/surface/isosurface_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "osteomill/volume/isosurface.h"

namespace osteomill {

namespace {

constexpr double kStep_voxels = 0.5;
constexpr double kTolerance_mm = 1e-3;

// A line in voxel coordinates, with mm of W as its parameter, and the part of it in a box.
struct VoxelLine {
  Vec3 origin;
  Vec3 per_mm;
  double first_mm = -std::numeric_limits<double>::infinity();
  double last_mm = std::numeric_limits<double>::infinity();
  int entry_axis = 0;

  Vec3 at(double mm) const { return origin + mm * per_mm; }
};

std::optional<VoxelLine> line_in_box(const GridGeometry& geometry, const Vec3& first, const Vec3& last,
                                     const Vec3& origin_W, const Vec3& direction_W) {
  VoxelLine line;
  line.origin = geometry.voxel_from_world(origin_W);
  line.per_mm = (geometry.direction.transpose() * direction_W).cwiseQuotient(geometry.spacing_mm);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(line.per_mm[axis]) < 1e-12) {
      if (line.origin[axis] < first[axis] || line.origin[axis] > last[axis]) return std::nullopt;
      continue;
    }
    const double at_first = (first[axis] - line.origin[axis]) / line.per_mm[axis];
    const double at_last = (last[axis] - line.origin[axis]) / line.per_mm[axis];
    if (std::min(at_first, at_last) > line.first_mm) {
      line.first_mm = std::min(at_first, at_last);
      line.entry_axis = axis;
    }
    line.last_mm = std::min(line.last_mm, std::max(at_first, at_last));
  }
  if (!(line.first_mm <= line.last_mm)) return std::nullopt;
  return line;
}

VoxelIndex cell_at(const GridGeometry& geometry, const Vec3& voxel) {
  const auto clamped = [&](int axis) {
    return std::clamp(static_cast<int>(std::floor(voxel[axis])), 0,
                      geometry.dims[static_cast<std::size_t>(axis)] - 1);
  };
  return {clamped(0), clamped(1), clamped(2)};
}

// Where the line leaves the brick of a cell.
double brick_exit_mm(const VoxelLine& line, const VoxelIndex& cell) {
  const std::array<int, 3> index{cell.i, cell.j, cell.k};
  double exit_mm = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double slope = line.per_mm[axis];
    if (std::abs(slope) < 1e-12) continue;
    const int brick = index[static_cast<std::size_t>(axis)] / BrickRanges::kBrickVoxels;
    const double border = BrickRanges::kBrickVoxels * (slope > 0 ? brick + 1 : brick);
    exit_mm = std::min(exit_mm, (border - line.origin[axis]) / slope);
  }
  return exit_mm;
}

// The gradient averaged over a voxel to all sides: smoother than the one that forces are made from, which
// lets voxels show as terraces in glancing light.
std::optional<Vec3> picture_normal(const Volume& volume, const Vec3& point_W) {
  const GridGeometry& geometry = volume.geometry();
  Vec3 gradient = density_gradient(volume.grid(), point_W, GradientKernel::smoothed);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 voxel = geometry.spacing_mm[axis] * geometry.direction.col(axis);
    gradient += density_gradient(volume.grid(), point_W + voxel, GradientKernel::smoothed) +
                density_gradient(volume.grid(), point_W - voxel, GradientKernel::smoothed);
  }
  const double steepness = gradient.norm();
  if (!(steepness > 1e-9)) return std::nullopt;
  return -gradient / steepness;
}

}  // namespace

BoneRays::BoneRays(const Volume& volume) : volume_(volume) {
  const auto& dims = volume.geometry().dims;
  const BrickRanges& bricks = volume.bricks();
  VoxelBox bone_bricks;
  for (int bk = 0; bk < bricks.dims()[2]; ++bk) {
    for (int bj = 0; bj < bricks.dims()[1]; ++bj) {
      for (int bi = 0; bi < bricks.dims()[0]; ++bi) {
        if (static_cast<double>(bricks.at(bi, bj, bk).greatest) > volume.isovalue()) {
          bone_bricks.include({bi, bj, bk});
        }
      }
    }
  }
  const VoxelIndex& first = bone_bricks.first;
  const VoxelIndex& last = bone_bricks.last;
  first_voxel_ = BrickRanges::kBrickVoxels * Vec3(first.i, first.j, first.k);
  last_voxel_ = (BrickRanges::kBrickVoxels * Vec3(last.i + 1, last.j + 1, last.k + 1))
                    .cwiseMin(Vec3(dims[0] - 1, dims[1] - 1, dims[2] - 1));
  if (bone_bricks.empty()) last_voxel_ = Vec3::Constant(-1);
}

RayHit BoneRays::hit_between(const Vec3& outside_W, const Vec3& inside_W, const Vec3& direction_W) const {
  const Vec3 point_W = bisect_crossing(volume_, outside_W, inside_W, kTolerance_mm);
  return {point_W, picture_normal(volume_, point_W).value_or(-direction_W)};
}

std::optional<RayHit> BoneRays::first_on_line(const Vec3& origin_W, const Vec3& direction_W) const {
  const GridGeometry& geometry = volume_.geometry();
  const std::optional<VoxelLine> line =
      line_in_box(geometry, first_voxel_, last_voxel_, origin_W, direction_W);
  if (!line) return std::nullopt;
  const double step_mm = kStep_voxels * geometry.spacing_mm.minCoeff();
  const auto point_W = [&](double mm) -> Vec3 { return origin_W + mm * direction_W; };

  double outside_mm = line->first_mm;
  if (density_at_voxel(volume_.grid(), line->at(outside_mm)) > volume_.isovalue()) {
    const double side = line->per_mm[line->entry_axis] > 0 ? -1 : 1;
    return RayHit{point_W(outside_mm), side * geometry.direction.col(line->entry_axis)};
  }
  for (double mm = outside_mm; mm <= line->last_mm; mm += step_mm) {
    const Vec3 voxel = line->at(mm);
    const VoxelIndex cell = cell_at(geometry, voxel);
    if (static_cast<double>(volume_.bricks().around(cell).greatest) <= volume_.isovalue()) {
      const double exit_mm = brick_exit_mm(*line, cell);
      outside_mm = std::max(mm, std::min(exit_mm, line->last_mm));
      // A hair less than a step beyond, so that the next step begins just inside the next brick.
      mm = std::max(mm, exit_mm - step_mm * (1 - 1e-4));
      continue;
    }
    if (density_at_voxel(volume_.grid(), voxel) > volume_.isovalue()) {
      return hit_between(point_W(outside_mm), point_W(mm), direction_W);
    }
    outside_mm = mm;
  }
  return std::nullopt;
}

}  // namespace osteomill
