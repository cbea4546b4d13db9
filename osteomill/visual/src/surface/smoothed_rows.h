#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace osteomill {

/// A range of rows along i in a cube of numbers.
struct RowBox {
  int first_j, last_j;
  int first_k, last_k;
};

/// Smooths the rows with weights 1, 2, 1 along each axis, without normalizing: 64 times a mean over about a
/// voxel in all directions. `value` is applied to each row of the cube first. The first and last number of
/// each row are not valid, and the rows must not lie on the cube's faces. Results are bit-identical for any
/// choice of rows.
template <int kSide, typename Value>
void smooth_rows(const float* cube, const RowBox& rows, const Value& value, float* sums) {
  using Row = Eigen::Array<float, kSide, 1>;
  constexpr auto kRows = static_cast<std::size_t>(kSide);
  const auto offset = [](int j, int k) { return static_cast<std::size_t>(kSide * (j + kSide * k)); };
  const auto third = [](int n) { return static_cast<std::size_t>(n + 3) % 3; };
  // Three rows across j, and three layers across k of rows already summed along j.
  std::array<Row, 3> near;
  std::array<std::array<Row, kRows>, 3> layers;
  std::array<float, kRows + 2> padded{};
  for (int k = rows.first_k - 1; k <= rows.last_k + 1; ++k) {
    auto& layer = layers[third(k)];
    for (int j = rows.first_j - 1; j <= rows.last_j + 1; ++j) {
      near[third(j)] = value(Eigen::Map<const Row>(cube + offset(j, k)));
      if (j <= rows.first_j) continue;
      layer[static_cast<std::size_t>(j - 1)] = near[third(j - 2)] + 2 * near[third(j - 1)] + near[third(j)];
    }
    if (k <= rows.first_k) continue;
    const auto& before = layers[third(k - 2)];
    const auto& here = layers[third(k - 1)];
    for (int j = rows.first_j; j <= rows.last_j; ++j) {
      const auto row = static_cast<std::size_t>(j);
      Eigen::Map<Row> whole(padded.data() + 1);
      whole = before[row] + 2 * here[row] + layer[row];
      Eigen::Map<Row>(sums + offset(j, k - 1)) =
          Eigen::Map<const Row>(padded.data()) + 2 * whole + Eigen::Map<const Row>(padded.data() + 2);
    }
  }
}

}  // namespace osteomill
