#include "osteomill/haptics/surface_points/vertex_springs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

namespace {

constexpr double kLeastLook_mm = 0.045;
constexpr double kTolerance_mm = 1e-4;

// A straight way through the grid in continuous voxel coordinates: `origin + t_mm * way`.
struct VoxelRay {
  Vec3 origin;
  Vec3 way;
};

struct Sample {
  double at_mm;
  double above;  // density above the isovalue
};

double above_isovalue(const Volume& volume, const VoxelRay& ray, double at_mm) {
  return density_at_voxel(volume.grid(), ray.origin + at_mm * ray.way) - volume.isovalue();
}

// Regula falsi with the Illinois halving, which keeps one end from standing still.
double close_in(const Volume& volume, const VoxelRay& ray, Sample outside, Sample inside) {
  for (int n = 0; n < 8 && inside.at_mm - outside.at_mm > kTolerance_mm; ++n) {
    // A density that is the isovalue's itself says nothing of how far the crossing is.
    const double fraction = outside.above < 0 ? outside.above / (outside.above - inside.above) : 0.5;
    const double at_mm = outside.at_mm + fraction * (inside.at_mm - outside.at_mm);
    const double above = above_isovalue(volume, ray, at_mm);
    if (std::min(inside.at_mm - at_mm, at_mm - outside.at_mm) < kTolerance_mm) return at_mm;
    if (above > 0) {
      inside = {at_mm, above};
      outside.above *= 0.5;
    } else {
      outside = {at_mm, above};
      inside.above *= 0.5;
    }
  }
  return outside.at_mm;
}

// Where, in [from_mm, to_mm], bone is first met along the ray; nothing where `from_mm` is in bone.
std::optional<double> first_bone(const Volume& volume, const VoxelRay& ray, double from_mm, double to_mm) {
  Sample before{from_mm, above_isovalue(volume, ray, from_mm)};
  if (before.above > 0) return std::nullopt;
  const double looks_mm = std::max(0.5 / ray.way.norm(), kLeastLook_mm);
  const int looks = static_cast<int>(std::clamp(std::ceil((to_mm - from_mm) / looks_mm), 1.0, 2e4));
  for (int n = 1; n <= looks; ++n) {
    const double at_mm = from_mm + n * (to_mm - from_mm) / looks;
    const Sample here{at_mm, above_isovalue(volume, ray, at_mm)};
    if (here.above > 0) return close_in(volume, ray, before, here);
    before = here;
  }
  return std::nullopt;
}

// How far along the segment from `from_W` to `to_W` bone is first met, as a share in [0, 1]; nothing where it
// is not, or where `from_W` is in bone.
std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W,
                                    double known_free_mm) {
  const double way_mm = (to_W - from_W).norm();
  if (way_mm == 0) return std::nullopt;
  const Vec3 from = volume.geometry().voxel_from_world(from_W);
  const VoxelRay ray{from, (volume.geometry().voxel_from_world(to_W) - from) / way_mm};
  const auto share = [&](double begin_mm, double end_mm) {
    std::optional<double> met = first_bone(volume, ray, begin_mm, end_mm);
    if (met) *met /= way_mm;
    return met;
  };
  if (!(known_free_mm > 0)) return share(0, way_mm);
  const double free_mm = std::min(way_mm, known_free_mm);
  if (above_isovalue(volume, ray, free_mm) > 0) return share(0, free_mm);
  return free_mm < way_mm ? share(free_mm, way_mm) : std::nullopt;
}

}  // namespace

Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W) {
  const double vertex_density = density_at(volume.grid(), vertex_W);
  if (!(vertex_density > volume.isovalue())) return Vec3::Zero();
  const double free_density = density_at(volume.grid(), free_W);
  const double share = (vertex_density - volume.isovalue()) / (vertex_density - free_density);
  return share * (free_W - vertex_W);
}

Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm) {
  if (known_free_mm <= 0 && is_bone_at(volume, free_W)) return free_W - vertex_W;
  const std::optional<double> share = share_to_bone(volume, free_W, vertex_W, known_free_mm);
  return share ? Vec3((1 - *share) * (free_W - vertex_W)) : Vec3(Vec3::Zero());
}

bool bone_near_disc(const Volume& volume, const Vec3& centre_W, const Vec3& axis_W, double radius_mm) {
  const GridGeometry& geometry = volume.geometry();
  const Vec3 axis = geometry.direction.transpose() * axis_W;
  const Vec3 centre = geometry.voxel_from_world(centre_W);
  std::array<int, 3> first;
  std::array<int, 3> last;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const double extent =
        radius_mm * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i])) / geometry.spacing_mm[i] + 1e-6;
    // Density falls off within a voxel beyond the border, so a disc there asks the border's bricks.
    const double max = geometry.dims[n] - 1;
    const auto brick = [&](double voxel) {
      return static_cast<int>(std::clamp(voxel, 0.0, max)) / BlockRanges::kBrickVoxels;
    };
    first[n] = brick(std::floor(centre[i] - extent));
    last[n] = brick(std::floor(centre[i] + extent));
  }
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        if (static_cast<double>(volume.ranges().at(i, j, k).max) > volume.isovalue()) return true;
      }
    }
  }
  return false;
}

}  // namespace osteomill::surface_points
