#include "osteomill/study/vertex_search.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "osteomill/base/distribution.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/haptics/sample_points.h"

namespace osteomill {

namespace {

constexpr int kSides = 1000;
constexpr int kPresses = 100;
constexpr double kDeepest = 0.5;
// Burr and shaft have a radius of 1 mm, so that depths are fractions of it; the shaft has one circle, at this
// distance from the burr's centre.
const MillingTool kTool{1, 1, 2};

Volume linear_wall() {
  GridGeometry geometry;
  geometry.dims = {9, 9, 9};
  geometry.origin_mm = Vec3::Constant(-4);
  std::vector<float> densities;
  for (int k = 0; k < 9; ++k) densities.insert(densities.end(), 81, static_cast<float>(4 - k));
  return Volume(DensityGrid(geometry, std::move(densities)), 0);
}

std::vector<Quat> sides(bool circle) {
  std::vector<Quat> turns;
  if (!circle) {
    for (const Vec3& side_T : spiral_directions(kSides))
      turns.push_back(smallest_rotation(side_T, -Vec3::UnitZ()));
    return turns;
  }
  const Quat lying = smallest_rotation(Vec3::UnitZ(), Vec3::UnitX());
  for (int n = 0; n < kSides; ++n) {
    const double roll_rad = 2 * std::numbers::pi * (n + 0.5) / kSides;
    turns.push_back(lying * quaternion_from_rotation_vector(roll_rad * Vec3::UnitZ()));
  }
  return turns;
}

// A circle is felt only as a torque, (21); its force is perpendicular to the lever arm.
Vec3 force_N(HapticAlgorithm& algorithm, bool circle, const Pose& X_WD) {
  const Wrench wrench = algorithm.step(X_WD, 1e-3).wrench;
  return circle ? Vec3(wrench.torque_Nmm.cross(shaft_direction(X_WD))) : wrench.force_N;
}

VertexSearchRow press(bool circle, int vertices, const Volume& wall) {
  const auto algorithm =
      make_algorithm(algorithm_named("surface-points"),
                     {.named = {{"surface-points", "slices", 1},
                                {"surface-points", circle ? "circle-vertices" : "sphere-vertices",
                                 static_cast<double>(vertices)}}});
  algorithm->prepare({&wall, kTool});
  VertexSearchRow row{.part = circle ? "circle" : "sphere", .vertices = vertices};
  std::vector<double> off_deg, sizes_N;
  double sum_N = 0;
  for (const Quat& side : sides(circle)) {
    Vec3 force = Vec3::Zero();
    for (int n = 1; n <= kPresses; ++n) {
      const double depth_mm = kDeepest * n / kPresses;
      if (force.isZero(0)) row.unseen_worst = std::max(row.unseen_worst, depth_mm);
      force = force_N(*algorithm, circle, {{0, 0, 1 - depth_mm}, side});
    }
    const double cosine = force.isZero(0) ? -1 : force.normalized().z();
    off_deg.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
    sizes_N.push_back(force.norm());
    sum_N += force.norm();
  }
  for (const double size_N : sizes_N)
    row.size_off_worst = std::max(row.size_off_worst, std::abs(size_N * kSides / sum_N - 1));
  const Distribution off = distribution_of(off_deg);
  row.direction_deg_median = off.median;
  row.direction_deg_worst = off.max;
  row.suffices = off.max <= VertexSearchRow::kMaxDirection_deg &&
                 row.size_off_worst <= VertexSearchRow::kMaxSizeOff &&
                 row.unseen_worst <= VertexSearchRow::kMaxUnseen;
  return row;
}

}  // namespace

template <>
const std::vector<Field<VertexSearchRow>>& fields_of<VertexSearchRow>() {
  using V = VertexSearchRow;
  constexpr NumberRange kAny = NumberRange::not_negative();
  static const std::vector<Field<V>> all{
      field<V>({"vertices", "", kAny, "vertices"}, &V::vertices),
      field<V>({"direction_deg_median", "°", kAny, "force off the normal, median"}, &V::direction_deg_median),
      field<V>({"direction_deg_worst", "°", kAny, "force off the normal, worst"}, &V::direction_deg_worst),
      field<V>({"size_off_worst", "", kAny, "deviation from mean size, share of it, worst"},
               &V::size_off_worst),
      field<V>({"unseen_worst", "", kAny, "greatest undetected depth, share of the radius"},
               &V::unseen_worst),
      field<V>({"suffices", "", NumberRange::on_or_off(), "suffices"}, &V::suffices)};
  return all;
}

std::vector<VertexSearchRow> search_vertices() {
  const Volume wall = linear_wall();
  std::vector<VertexSearchRow> rows;
  for (const int count : {6, 8, 12, 16, 20, 24, 32, 48, 96}) rows.push_back(press(false, count, wall));
  for (const int count : {3, 4, 6, 8, 12, 16, 32}) rows.push_back(press(true, count, wall));
  return rows;
}

int least_vertices(const std::vector<VertexSearchRow>& rows, const std::string& part) {
  int least = 0;
  for (const VertexSearchRow& row : rows) {
    if (row.part != part) continue;
    if (!row.suffices)
      least = 0;
    else if (least == 0)
      least = row.vertices;
  }
  return least;
}

}  // namespace osteomill
