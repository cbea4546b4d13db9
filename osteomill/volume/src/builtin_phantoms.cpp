#include "osteomill/volume/builtin_phantoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "osteomill/base/row_major.h"

namespace osteomill {

namespace {

// Everything below is in mm, z outward, and uses only + - * / and sqrt, which are bit-identical on every
// machine.

constexpr double kSpacing_mm = 0.25;
constexpr double kAir = 0;
constexpr double kSoftTissue = 40;
constexpr double kSoftBone = 1200;
constexpr double kHardBone = 1800;

// Returns the fraction of a voxel inside a surface, given its centre's signed distance (negative inside).
double inside_fraction(double distance_mm) {
  return std::clamp(0.5 - distance_mm / (2 * kSpacing_mm), 0.0, 1.0);
}

double mixed(double below, double above, double share_above) {
  return below + share_above * (above - below);
}

template <typename Density>
DensityGrid grid_of(const std::array<int, 3>& dims, double top_z_mm, const Density& density) {
  GridGeometry geometry;
  geometry.dims = dims;
  geometry.spacing_mm = Vec3::Constant(kSpacing_mm);
  geometry.origin_mm = {-0.5 * (dims[0] - 1) * kSpacing_mm, -0.5 * (dims[1] - 1) * kSpacing_mm,
                        top_z_mm - (dims[2] - 1) * kSpacing_mm};
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    densities.push_back(static_cast<float>(density(geometry.world_from_voxel(v))));
  });
  return DensityGrid(geometry, std::move(densities));
}

double layers_density(const Vec3& p) {
  const double hard_share =
      std::max(inside_fraction(-2 - p.z()), inside_fraction(std::abs(p.z() + 5.5) - 0.5));
  return mixed(kAir, mixed(kSoftBone, kHardBone, hard_share), inside_fraction(p.z()));
}

DensityGrid layers() {
  return grid_of({96, 96, 64}, 4 + 0.5 * kSpacing_mm, layers_density);
}

// Mastoid phantom: signed distance of a round rod, whose ends are rounded or outside the grid.

double rod_distance_mm(const Vec3& p, const Vec3& from, const Vec3& to, double radius_mm) {
  const Vec3 along = to - from;
  const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - t * along).norm() - radius_mm;
}

double soft_tissue_distance_mm(const Vec3& p) {
  const double nerve = rod_distance_mm(p, {-1, -20, -13}, {-1, 20, -13}, 0.75);
  const double sinus = rod_distance_mm(p, {-9, -20, -6}, {-9, 20, -6}, 3);
  const double dura = 9 - p.y();
  return std::min({nerve, sinus, dura});
}

// Returns a pseudo-random number from 0 to 1 for a node of the cell lattice.
double lattice_number(int i, int j, int k, std::uint32_t which) {
  std::uint32_t x = static_cast<std::uint32_t>(i) * 73856093u ^ static_cast<std::uint32_t>(j) * 19349663u ^
                    static_cast<std::uint32_t>(k) * 83492791u ^ which * 2654435761u;
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  x = (x ^ (x >> 16)) * 0x45d9f3bu;
  return static_cast<double>((x ^ (x >> 16)) & 0xffffu) / 65535.0;
}

// Signed distance of the antrum and the air cells, which lie on a jittered lattice and grow with depth.
double cell_distance_mm(const Vec3& p) {
  constexpr double kApart_mm = 2.4;
  const Vec3 at = p / kApart_mm;
  const int i0 = static_cast<int>(std::floor(at.x())), j0 = static_cast<int>(std::floor(at.y())),
            k0 = static_cast<int>(std::floor(at.z()));
  double least_mm = (p - Vec3(1, 3, -9)).norm() - 2;
  for_each(VoxelBox{{i0 - 1, j0 - 1, k0 - 1}, {i0 + 1, j0 + 1, k0 + 1}}, [&](const VoxelIndex& cell) {
    const auto number = [&](std::uint32_t which) { return lattice_number(cell.i, cell.j, cell.k, which); };
    const Vec3 centre = kApart_mm * Vec3(cell.i + 0.3 + 0.4 * number(1), cell.j + 0.3 + 0.4 * number(2),
                                         cell.k + 0.3 + 0.4 * number(3));
    const double depth_mm = -2 - centre.z();
    if (depth_mm < 1) return;
    const double radius_mm = 0.5 + 0.35 * number(4) + 0.02 * std::min(depth_mm, 10.0);
    least_mm = std::min(least_mm, (p - centre).norm() - radius_mm);
  });
  return least_mm;
}

double mastoid_density(const Vec3& p) {
  constexpr double kPlate_mm = 1.3, kCortex_mm = 2;
  const double outside_mm = p.z();
  if (outside_mm > 2 * kSpacing_mm) return kAir;
  const double tissue_mm = soft_tissue_distance_mm(p);
  // Cells spare the cortex and the plates over nerve, sinus and dura.
  const double cell_mm = std::max({cell_distance_mm(p), kPlate_mm - tissue_mm, outside_mm + kCortex_mm});
  const double bone =
      mixed(kSoftBone, kHardBone, inside_fraction(std::min(tissue_mm - kPlate_mm, -kCortex_mm - outside_mm)));
  const double with_cells = mixed(bone, kAir, inside_fraction(cell_mm));
  const double with_tissue = mixed(with_cells, kSoftTissue, inside_fraction(tissue_mm));
  return mixed(kAir, with_tissue, inside_fraction(outside_mm));
}

DensityGrid mastoid() {
  return grid_of({104, 120, 96}, 6 + 0.5 * kSpacing_mm, mastoid_density);
}

constexpr std::array<BuiltinPhantom, 2> kPhantoms{{{"layers", 750, layers}, {"mastoid", 750, mastoid}}};

}  // namespace

std::span<const BuiltinPhantom> builtin_phantoms() {
  return kPhantoms;
}

}  // namespace osteomill
