#include "verification/bone_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/haptics/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::verification {

namespace {

constexpr int kCentrelineVertices = 51;
constexpr double kBin_mm = 1;
constexpr double kBinReach_mm = 0.87;  // half the diagonal of a bin

// Adds, for each axis, the point between the voxel and its next neighbour at which the density crosses the
// isovalue, in W.
void add_crossings(const Volume& volume, const VoxelIndex& v, std::vector<Vec3>& points) {
  const double here = volume.grid()[v];
  const std::array<VoxelIndex, 3> neighbours{{{v.i + 1, v.j, v.k}, {v.i, v.j + 1, v.k}, {v.i, v.j, v.k + 1}}};
  for (const VoxelIndex& next : neighbours) {
    if (!volume.grid().contains(next) || volume.is_bone(next) == volume.is_bone(v)) continue;
    const double share = (volume.isovalue() - here) / (volume.grid()[next] - here);
    const Vec3 from(v.i, v.j, v.k);
    const Vec3 to(next.i, next.j, next.k);
    points.push_back(volume.geometry().world_from_voxel(Vec3(from + share * (to - from))));
  }
}

}  // namespace

BoneSurface::BoneSurface(const Volume& volume) : volume_(volume) {
  std::vector<Vec3> crossings;
  const std::array<int, 3>& dims = volume.geometry().dims;
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) add_crossings(volume, {i, j, k}, crossings);
    }
  }
  std::map<std::array<long, 3>, std::vector<Vec3>> sorted;
  for (const Vec3& point : crossings) {
    sorted[{std::lround(point.x() / kBin_mm), std::lround(point.y() / kBin_mm),
            std::lround(point.z() / kBin_mm)}]
        .push_back(point);
  }
  for (const auto& [cell, inside] : sorted) {
    const std::size_t first = points_.size();
    points_.insert(points_.end(), inside.begin(), inside.end());
    const Vec3 centre(static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                      static_cast<double>(cell[2]));
    bins_.push_back({kBin_mm * centre, first, points_.size()});
  }
}

double BoneSurface::deepest_mm(const MillingTool& tool, const Pose& X_WT) const {
  const Pose X_TW = X_WT.inverse();
  double nearest = 1e9;
  for (const Bin& bin : bins_) {
    if (tool_distance(tool, X_TW * bin.centre_W).distance_mm > std::min(nearest, 0.0) + kBinReach_mm)
      continue;
    for (std::size_t n = bin.first; n < bin.last; ++n) {
      nearest = std::min(nearest, tool_distance(tool, X_TW * points_[n]).distance_mm);
    }
  }
  return -nearest;
}

double BoneSurface::centreline_depth_mm(const MillingTool& tool, const Pose& X_WT) const {
  double deepest = 0;
  for (const Vec3& vertex_T : centreline_vertices(tool, kCentrelineVertices)) {
    const Vec3 vertex_W = X_WT * vertex_T;
    if (density_at(volume_.grid(), vertex_W) <= volume_.isovalue()) continue;
    deepest = std::max(deepest, distance_mm(vertex_W));
  }
  return deepest;
}

double BoneSurface::distance_mm(const Vec3& point_W) const {
  double nearest = 1e9;
  for (const Bin& bin : bins_) {
    if ((bin.centre_W - point_W).norm() > nearest + kBinReach_mm) continue;
    for (std::size_t n = bin.first; n < bin.last; ++n) {
      nearest = std::min(nearest, (points_[n] - point_W).norm());
    }
  }
  return nearest;
}

}  // namespace osteomill::verification
