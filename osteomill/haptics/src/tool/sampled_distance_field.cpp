#include "tool/sampled_distance_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "osteomill/base/positive.h"

namespace osteomill {

namespace {

constexpr double kMarginNodes = 2;
constexpr double kMaxNodes = 16e6;
constexpr double kSuitableNodes = 2e6;

// Returns the number of cells of the box with its margin along each axis, as doubles, because it may exceed
// an int.
Vec3 cells_of(const ToolBox& tool_box, double spacing_mm) {
  const Vec3 size_mm = tool_box.max_mm - tool_box.min_mm;
  return (size_mm / spacing_mm).array().ceil() + 2 * kMarginNodes;
}

}  // namespace

double SampledDistanceField::suitable_spacing_mm(const MillingTool& tool) {
  require_valid(tool);
  double spacing_mm = std::min(tool.burr_radius_mm, tool.shaft_radius_mm) / 25;
  while (cells_of(bounding_box(tool), spacing_mm).prod() > kSuitableNodes) spacing_mm *= 1.05;
  return spacing_mm;
}

SampledDistanceField::SampledDistanceField(const MillingTool& tool, double spacing_mm)
    : spacing_mm_(spacing_mm) {
  require_valid(tool);
  require_positive(spacing_mm, "the distance field's spacing (mm)");
  const ToolBox tool_box = bounding_box(tool);
  const Vec3 cells = cells_of(tool_box, spacing_mm);
  if (!((cells + Vec3::Ones()).prod() <= kMaxNodes)) {
    throw std::invalid_argument("the distance field's spacing is too fine for this tool");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    dims_[axis] = static_cast<int>(cells[static_cast<Eigen::Index>(axis)]) + 1;
  }
  const Vec3 middle = 0.5 * (tool_box.min_mm + tool_box.max_mm);
  box_ = {middle - 0.5 * spacing_mm * cells, middle + 0.5 * spacing_mm * cells};
  fill(tool);
}

void SampledDistanceField::fill(const MillingTool& tool) {
  nodes_.resize(node_index(0, 0, dims_[2]));
  for (int k = 0; k < dims_[2]; ++k) {
    for (int j = 0; j < dims_[1]; ++j) {
      for (int i = 0; i < dims_[0]; ++i) {
        const ToolDistance here = tool_distance(tool, box_.min_mm + spacing_mm_ * Vec3(i, j, k));
        nodes_[node_index(i, j, k)] = {
            static_cast<float>(here.distance_mm), static_cast<float>(here.outward_T.x()),
            static_cast<float>(here.outward_T.y()), static_cast<float>(here.outward_T.z())};
      }
    }
  }
}

std::optional<ToolDistance> SampledDistanceField::at(const Vec3& point_T) const noexcept {
  const Vec3 coordinate = (point_T - box_.min_mm) / spacing_mm_;
  int cell[3];
  double weight[3][2];
  for (int axis = 0; axis < 3; ++axis) {
    const double c = coordinate[axis];
    if (!(c >= 0 && c < dims_[static_cast<std::size_t>(axis)] - 1)) return std::nullopt;
    cell[axis] = static_cast<int>(c);
    weight[axis][1] = c - cell[axis];
    weight[axis][0] = 1 - weight[axis][1];
  }
  double sum[4] = {0, 0, 0, 0};
  for (int corner = 0; corner < 8; ++corner) {
    const int di = corner & 1, dj = (corner >> 1) & 1, dk = corner >> 2;
    const double share = weight[0][di] * weight[1][dj] * weight[2][dk];
    const Node& node = nodes_[node_index(cell[0] + di, cell[1] + dj, cell[2] + dk)];
    for (std::size_t n = 0; n < 4; ++n) sum[n] += share * static_cast<double>(node[n]);
  }
  const Vec3 gradient(sum[1], sum[2], sum[3]);
  const double length = gradient.norm();
  // Opposite gradients may cancel on the axis, on which tool_distance gives an arbitrary direction too.
  return ToolDistance{sum[0], length > 1e-6 ? Vec3(gradient / length) : Vec3(-Vec3::UnitZ())};
}

}  // namespace osteomill
