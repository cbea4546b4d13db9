#include "osteomill/volume/boundaries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

constexpr std::size_t kLevels = 200;
using Curve = std::array<double, kLevels>;

struct Sample {
  float density;
  float gradient_per_mm;
};

std::vector<Sample> samples_of(const DensityGrid& grid) {
  constexpr double kMaxSamples = 4e6;
  const GridGeometry& geometry = grid.geometry();
  const auto& dims = geometry.dims;
  const int step =
      static_cast<int>(std::ceil(std::cbrt(static_cast<double>(geometry.voxel_count()) / kMaxSamples)));
  std::vector<Sample> samples;
  for (int k = 0; k < dims[2]; k += step) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; j += step) {
      for (int i = 0; i < dims[0]; i += step) {
        Vec3 gradient;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          std::array<int, 3> below{i, j, k}, above = below;
          below[axis] = std::max(below[axis] - 1, 0);
          above[axis] = std::min(above[axis] + 1, dims[axis] - 1);
          const double rise = static_cast<double>(grid[{above[0], above[1], above[2]}]) -
                              static_cast<double>(grid[{below[0], below[1], below[2]}]);
          const auto n = static_cast<Eigen::Index>(axis);
          gradient[n] = rise / (2 * geometry.spacing_mm[n]);
        }
        samples.push_back({grid[{i, j, k}], static_cast<float>(gradient.norm())});
      }
    }
  }
  return samples;
}

Curve blurred(const Curve& curve) {
  constexpr double kBlur_levels = 2;
  Curve result{};
  for (std::size_t n = 0; n < kLevels; ++n) {
    double weights = 0;
    for (std::size_t m = 0; m < kLevels; ++m) {
      const double off = (static_cast<double>(m) - static_cast<double>(n)) / kBlur_levels;
      const double weight = std::exp(-0.5 * off * off);
      result[n] += weight * curve[m];
      weights += weight;
    }
    result[n] /= weights;
  }
  return result;
}

// The mean gradient along the isosurface of a density.
struct Level {
  double density;
  double gradient;
};

bool is_less_sharp(const Level& a, const Level& b) {
  return a.gradient < b.gradient;
}

// The least gradient on the way from a level, down or up, to one that is sharper than it.
template <typename Way>
double least_before_sharper(const Level& from, Way next, Way end) {
  const Way sharper =
      std::find_if(next, end, [&](const Level& level) { return level.gradient > from.gradient; });
  return next == sharper ? from.gradient : std::min_element(next, sharper, is_less_sharp)->gradient;
}

}  // namespace

std::vector<Boundary> boundaries_in(const DensityGrid& grid) {
  constexpr double kProminence = 0.1, kLeastArea = 0.01;
  std::vector<Sample> samples = samples_of(grid);
  // The rarest at both ends would only make the levels wide.
  const auto rare = static_cast<std::ptrdiff_t>(samples.size() / 2000);
  const auto density_at = [&](std::ptrdiff_t place) {
    std::nth_element(samples.begin(), samples.begin() + place, samples.end(),
                     [](const Sample& a, const Sample& b) { return a.density < b.density; });
    return static_cast<double>(samples[static_cast<std::size_t>(place)].density);
  };
  const double min = density_at(rare), max = density_at(std::ssize(samples) - 1 - rare);
  if (!(max > min)) return {};
  const double width = (max - min) / kLevels;
  // An isosurface's area is what the gradient sums up to over the voxels that lie between two levels.
  Curve area{}, gradient{};
  for (const Sample& sample : samples) {
    const double level = (static_cast<double>(sample.density) - min) / width;
    if (!(level >= 0 && level <= kLevels)) continue;
    const auto n = std::min(static_cast<std::size_t>(level), kLevels - 1);
    const auto g = static_cast<double>(sample.gradient_per_mm);
    area[n] += g;
    gradient[n] += g * g;
  }
  area = blurred(area);
  gradient = blurred(gradient);
  const double least_area = kLeastArea * *std::max_element(area.begin(), area.end());
  std::vector<Level> levels;
  for (std::size_t n = 0; n < kLevels; ++n) {
    if (area[n] > 0 && area[n] >= least_area)
      levels.push_back({min + (static_cast<double>(n) + 0.5) * width, gradient[n] / area[n]});
  }
  std::vector<std::vector<Level>::const_iterator> sharpest;
  for (auto level = levels.cbegin(); level != levels.cend(); ++level) {
    const double below = least_before_sharper(*level, std::make_reverse_iterator(level), levels.crend());
    const double above = least_before_sharper(*level, std::next(level), levels.cend());
    if (level->gradient - std::max(below, above) >= kProminence * level->gradient && level->gradient > 0)
      sharpest.push_back(level);
  }
  std::vector<Boundary> boundaries;
  for (std::size_t n = 0; n < sharpest.size(); ++n) {
    const auto begin = n > 0 ? sharpest[n - 1] : levels.cbegin();
    const auto end = n + 1 < sharpest.size() ? sharpest[n + 1] : levels.cend();
    boundaries.push_back({sharpest[n]->density, std::min_element(begin, sharpest[n], is_less_sharp)->density,
                          std::min_element(sharpest[n], end, is_less_sharp)->density});
  }
  return boundaries;
}

}  // namespace osteomill
