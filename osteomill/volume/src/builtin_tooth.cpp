#include "osteomill/volume/builtin_tooth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "osteomill/base/row_major.h"

namespace osteomill {

namespace {

// Everything below is in mm: x mesial to distal, y buccal to lingual, z towards the cusps. Shapes are
// implicit functions, negative inside and roughly a distance near the surface. Uses only + - * / and sqrt,
// which are bit-identical on every machine.

constexpr double kSurroundings = 0;
constexpr double kPulp = 40;
constexpr double kDentine = 1500;
constexpr double kEnamel = 2800;

constexpr double kSpacing_mm = 0.125;
constexpr std::array<int, 3> kDims{256, 256, 176};
constexpr double kEdge_mm = 0.25;

constexpr double kNeck_z = 13.2;     // lower edge of the enamel
constexpr double kContour_z = 17.2;  // widest section of the crown

double square(double x) {
  return x * x;
}
double ramp(double x) {
  return std::clamp(x, 0.0, 1.0);
}
// Returns a ramp from 0 to 1 with zero slope at both ends.
double smooth_ramp(double x) {
  const double t = ramp(x);
  return t * t * (3 - 2 * t);
}
// Returns 1 at 0, falling to 0 at -1 and 1.
double bump(double x) {
  return square(std::max(0.0, 1 - x * x));
}

double smooth_min(double a, double b, double blend) {
  const double h = std::max(0.0, blend - std::abs(a - b));
  return std::min(a, b) - h * h / (4 * blend);
}
double smooth_max(double a, double b, double blend) {
  return -smooth_min(-a, -b, blend);
}

// Norm whose unit curve is an ellipse with slightly square shoulders, as in molars.
double shoulder_norm(double u, double v) {
  const double u2 = u * u, v2 = v * v;
  return std::sqrt(0.55 * (u2 + v2) + 0.45 * std::sqrt(u2 * u2 + v2 * v2));
}

// Piecewise parabolic wave of period 2 between -1 and 1.
double wave(double t) {
  const double turns = t - 2 * std::floor(0.5 * t);
  const double half = turns < 1 ? turns : turns - 1;
  return (turns < 1 ? 4 : -4) * half * (1 - half);
}

double rounded_cone_z(double dx, double dy, double tip_z, double slope) {
  constexpr double kRounding = 0.7;
  return tip_z - slope * (std::sqrt(dx * dx + dy * dy + kRounding * kRounding) - kRounding);
}

struct Cusp {
  double x, y, tip_z, slope;
};
constexpr std::array<Cusp, 4> kCusps{{{-2.55, -2.75, 20.75, 0.80},
                                      {2.35, -2.65, 20.45, 0.78},
                                      {-2.35, 2.55, 21.0, 0.88},
                                      {2.3, 2.45, 20.7, 0.86}}};

// Height of a cusp: a rounded cone with a lower lobe on either side and shallow grooves between them.
double cusp_z(const Cusp& cusp, double x, double y) {
  const double dx = x - cusp.x;
  const double dy = y - cusp.y;
  const double inwards = cusp.y > 0 ? -0.95 : 0.95;
  const double outer = rounded_cone_z(std::abs(dx) - 1.5, dy - inwards, cusp.tip_z - 0.95, 0.75 * cusp.slope);
  return smooth_max(rounded_cone_z(dx, dy, cusp.tip_z, cusp.slope), outer, 0.25);
}

// Height of the occlusal surface: cusps that meet in winding fissures, between marginal ridges.
double chewing_surface_z(double x, double y) {
  const double u = x + 0.16 * wave(0.7 * y + 0.2) + 0.1 * wave(1.6 * y);
  const double v = y + 0.2 * wave(0.45 * x + 0.4) + 0.08 * wave(1.5 * x + 0.5);
  double highest = -1e9, second = -1e9;
  for (const Cusp& cusp : kCusps) {
    const double height = cusp_z(cusp, u, v);
    second = std::max(second, std::min(height, highest));
    highest = std::max(highest, height);
  }
  const double fissure = 0.28 * bump((highest - second) / 0.55);
  const double fossa = 0.4 * bump(std::sqrt(square(x / 2.4) + square(y / 1.9)));
  const double ridge = 19.75 - 0.9 * square((std::abs(x) - 4.25) / 1.1) - 0.12 * square(y / 1.6);
  return smooth_max(highest - fissure - fossa, ridge, 0.5);
}

double crown(double x, double y, double z) {
  const double below = smooth_ramp((z - kNeck_z) / (kContour_z - kNeck_z));
  const double above = smooth_ramp((z - kContour_z) / 6.0);
  const double half_x = 4.35 + 1.15 * below - 1.6 * above;
  const double half_y = 4.15 + 1.1 * below - 1.75 * above;
  // Shallow furrow down both flanks, from between the cusps to the furcation of the roots.
  const double furrow = 0.33 * bump(x / 1.9) * (1 - 0.6 * bump((z - 15) / 2.5));
  const double flank = (shoulder_norm(x / half_x, y / (half_y - furrow)) - 1) * std::min(half_x, half_y);
  // The chewing surface does not matter far below it.
  const double top = z > 14 ? (z - chewing_surface_z(x, y)) * 0.8 : -10;
  return smooth_max(smooth_max(flank, top, 0.9), 9.9 - z, 2.2);
}

struct Root {
  double top_x, apex_x;   // position of the axis at kRootTop_z and at the apex
  double half_x, half_y;  // at the top
  double apex_z;
  double lean;  // outward bow of the axis at half length
};
constexpr double kRootTop_z = 13.0;
constexpr std::array<Root, 2> kRoots{
    {{-2.2, -3.7, 2.05, 3.75, 1.0, 0.28}, {2.15, 3.5, 2.0, 3.45, 1.5, 0.16}}};

double root_axis_x(const Root& root, double down) {
  const double bow = 4 * down * (1 - down) * (root.apex_x > 0 ? root.lean : -root.lean);
  return root.top_x + down * (root.apex_x - root.top_x) + bow;
}

double root(const Root& root, double x, double y, double z) {
  const double down = std::max(0.0, (kRootTop_z - z) / (kRootTop_z - root.apex_z));
  const double taper = 1 - 0.52 * std::min(down, 1.2);
  const double dx = (x - root_axis_x(root, std::min(down, 1.2))) / (root.half_x * taper);
  const double dy = y / (root.half_y * taper);
  const double end = square(square(down));
  const double round = (std::sqrt(dx * dx + dy * dy + end) - 1) * root.half_x * taper;
  return smooth_max(round, z - kRootTop_z, 1.0);
}

double tooth(double x, double y, double z) {
  if (z > 16) return crown(x, y, z);
  const double roots = smooth_min(root(kRoots[0], x, y, z), root(kRoots[1], x, y, z), 0.7);
  return smooth_min(crown(x, y, z), roots, 1.4);
}

// Round rod from `a` to `b`, tapering from radius `ra` to `rb`.
double rod(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb) {
  const Vec3 along = b - a;
  const double t = ramp((p - a).dot(along) / along.squaredNorm());
  return (p - a - t * along).norm() - (ra + t * (rb - ra));
}

double canal(const Root& root, double x, double y, double z) {
  const double end_z = root.apex_z + 1.2;
  const double down = std::clamp((kRootTop_z - z) / (kRootTop_z - root.apex_z), 0.0, 1.0);
  const double half_x = 0.5 - 0.3 * down;
  const double half_y = 1.25 - 0.95 * down;
  const double dx = (x - root_axis_x(root, down)) / half_x;
  const double round = (std::sqrt(dx * dx + square(y / half_y)) - 1) * half_x;
  return std::max({round, z - 14.5, end_z - z});
}

double pulp(double x, double y, double z) {
  const double u = x / 2.7, v = y / 2.3, w = (z - 13.9) / 1.25;
  double shape = (std::sqrt(std::sqrt(square(u * u) + square(v * v) + square(w * w))) - 1) * 1.25;
  for (const Cusp& cusp : kCusps) {
    if (z < 13) break;
    const Vec3 foot(0.55 * cusp.x, 0.5 * cusp.y, 14.4);
    const Vec3 tip(0.8 * cusp.x, 0.72 * cusp.y, 16.6);
    shape = smooth_min(shape, rod({x, y, z}, foot, tip, 0.6, 0.18), 0.5);
  }
  for (const Root& one : kRoots) shape = smooth_min(shape, canal(one, x, y, z), 0.4);
  return shape;
}

// Returns the enamel's thickness: 0 at the neck (slightly higher towards the adjacent teeth), largest on the
// cusps.
double enamel_thickness_mm(double x, double y, double z) {
  const double neck_z = kNeck_z + 0.7 * square(x / 4.5) - 0.3 * square(y / 4.3);
  const double up = (z - neck_z) / 3.2;
  if (up < 0) return up;
  return 1.35 * std::sqrt(ramp(up) * (2 - ramp(up))) + 0.65 * smooth_ramp((z - kContour_z) / 2.5);
}

// Converts the value of an implicit function near its surface to a distance in mm by dividing by its slope.
template <typename Shape>
double in_mm(const Shape& shape, double value, double x, double y, double z) {
  constexpr double kStep = 0.02;
  const double dx = shape(x + kStep, y, z) - value;
  const double dy = shape(x, y + kStep, z) - value;
  const double dz = shape(x, y, z + kStep) - value;
  const double slope = std::sqrt(dx * dx + dy * dy + dz * dz) / kStep;
  return value / std::max(slope, 0.3);
}

double inside_fraction(double distance_mm) {
  return ramp(0.5 - distance_mm / kEdge_mm);
}

double density(double x, double y, double z) {
  constexpr double kFar_mm = 1.0;
  const double value = tooth(x, y, z);
  if (value > kFar_mm) return kSurroundings;
  const double thickness_mm = enamel_thickness_mm(x, y, z);
  const bool enamel_near = thickness_mm > -kEdge_mm && value > -4;
  const double distance_mm = enamel_near || value > -kFar_mm ? in_mm(tooth, value, x, y, z) : value;
  const double tooth_share = inside_fraction(distance_mm);
  if (tooth_share <= 0) return kSurroundings;

  const double enamel_share =
      enamel_near ? ramp(0.5 + (thickness_mm + distance_mm) / kEdge_mm) * ramp(2 * thickness_mm / kEdge_mm)
                  : 0;
  const double hard = kDentine + enamel_share * (kEnamel - kDentine);
  const double pulp_value = value < -0.3 && std::abs(x) < 5 && z < 18 ? pulp(x, y, z) : kFar_mm;
  const double pulp_share = pulp_value < kFar_mm ? inside_fraction(in_mm(pulp, pulp_value, x, y, z)) : 0;
  return tooth_share * (hard + pulp_share * (kPulp - hard));
}

GridGeometry tooth_geometry(double refinement) {
  GridGeometry geometry;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    geometry.dims[axis] = static_cast<int>(std::lround(kDims[axis] * refinement));
  }
  const double spacing_mm = kSpacing_mm / refinement;
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  geometry.origin_mm = {-0.5 * (geometry.dims[0] - 1) * spacing_mm,
                        -0.5 * (geometry.dims[1] - 1) * spacing_mm, 0.5 * (spacing_mm - kSpacing_mm)};
  return geometry;
}

// Blocks of voxels are skipped if the tooth is farther from their centre than any of their voxels; kMaxSlope
// bounds the slope of tooth().
constexpr int kBlock = 8;
constexpr double kMaxSlope = 2.0;

void fill_block(const GridGeometry& geometry, const VoxelBox& block, std::vector<float>& densities) {
  const Vec3 first = geometry.world_from_voxel(block.first);
  const Vec3 last = geometry.world_from_voxel(block.last);
  const Vec3 middle = 0.5 * (first + last);
  const double reach_mm = 0.5 * (last - first).norm() + kEdge_mm;
  if (tooth(middle.x(), middle.y(), middle.z()) > kMaxSlope * reach_mm) return;
  for_each(block, [&](const VoxelIndex& v) {
    const Vec3 p = geometry.world_from_voxel(v);
    densities[row_major(geometry.dims, v.i, v.j, v.k)] = static_cast<float>(density(p.x(), p.y(), p.z()));
  });
}

}  // namespace

DensityGrid builtin_tooth(double refinement) {
  if (!(refinement >= 0.1 && refinement <= 8)) {
    throw std::invalid_argument("builtin_tooth: the refinement must be from 0.1 to 8");
  }
  const GridGeometry geometry = tooth_geometry(refinement);
  std::vector<float> densities(geometry.voxel_count(), static_cast<float>(kSurroundings));
  const VoxelBox all = geometry.all_voxels();
  for_each(all.bricks(kBlock), [&](const VoxelIndex& block) {
    fill_block(geometry, VoxelBox::of_brick(block, kBlock).intersected(all), densities);
  });
  return DensityGrid(geometry, std::move(densities));
}

}  // namespace osteomill
