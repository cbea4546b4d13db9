#include "osteomill/volume/isovalue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

struct Sample {
  double density;
  // Sum over the axes of the absolute difference between the voxel's two neighbours.
  double change;
  float gradient_per_mm;
};

bool is_less_dense(const Sample& a, const Sample& b) {
  return a.density < b.density;
}

// Samples every `step`th voxel along each axis, without those that have no density.
std::vector<Sample> samples_of(const DensityGrid& grid, int step) {
  const GridGeometry& geometry = grid.geometry();
  const auto& dims = geometry.dims;
  const auto has_density = [&](const std::array<int, 3>& v) {
    return grid.has_density(grid.linear_index({v[0], v[1], v[2]}));
  };
  const auto at = [&](const std::array<int, 3>& v, std::size_t axis, int by) {
    std::array<int, 3> near = v;
    near[axis] = std::clamp(near[axis] + by, 0, dims[axis] - 1);
    const auto& [i, j, k] = has_density(near) ? near : v;
    return static_cast<double>(grid[{i, j, k}]);
  };
  std::vector<Sample> samples;
  for (int k = 0; k < dims[2]; k += step) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; j += step) {
      for (int i = 0; i < dims[0]; i += step) {
        if (!has_density({i, j, k})) continue;
        double change = 0;
        Vec3 gradient;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double rise = at({i, j, k}, axis, 1) - at({i, j, k}, axis, -1);
          change += std::abs(rise);
          const auto n = static_cast<Eigen::Index>(axis);
          gradient[n] = rise / (2 * geometry.spacing_mm[n]);
        }
        samples.push_back(
            {static_cast<double>(grid[{i, j, k}]), change, static_cast<float>(gradient.norm())});
      }
    }
  }
  return samples;
}

std::vector<Sample> samples_of(const DensityGrid& grid) {
  constexpr double kMaxSamples = 4e6;
  const int step = static_cast<int>(
      std::ceil(std::cbrt(static_cast<double>(grid.geometry().voxel_count()) / kMaxSamples)));
  std::vector<Sample> samples = samples_of(grid, step);
  // Falls back to all voxels: few have a density, and none of these.
  return samples.empty() ? samples_of(grid, 1) : samples;
}

// Otsu's threshold (1979, eq. 18) on ascending samples: returns the size of the lower of the two classes with
// maximum between-class variance. Neither class is empty.
std::size_t lower_class(std::span<const Sample> samples) {
  const double lowest = samples.front().density;
  double all_sum = 0;
  for (const Sample& sample : samples) all_sum += sample.density - lowest;
  const auto all_count = static_cast<double>(samples.size());
  double sum = 0, greatest = -1;
  std::size_t best = 1;
  for (std::size_t n = 1; n < samples.size(); ++n) {
    sum += samples[n - 1].density - lowest;
    if (samples[n - 1].density == samples[n].density) continue;
    const auto count = static_cast<double>(n);
    const double difference = sum / count - (all_sum - sum) / (all_count - count);
    const double variance = count * (all_count - count) * difference * difference;
    if (variance > greatest) {
      greatest = variance;
      best = n;
    }
  }
  return best;
}

// Returns the mode of the densities among the quarter of the samples with the smallest change.
double commonest(std::span<const Sample> samples) {
  constexpr std::size_t kBins = 1024;
  constexpr int kBlur = 10;
  std::vector<double> changes;
  for (const Sample& sample : samples) changes.push_back(sample.change);
  const auto quarter = changes.begin() + static_cast<std::ptrdiff_t>((changes.size() - 1) / 4);
  std::nth_element(changes.begin(), quarter, changes.end());
  // Excludes outliers at both ends, which would only widen the bins.
  const std::size_t rare = samples.size() / 2000;
  const double min = samples[rare].density;
  const double max = samples[samples.size() - 1 - rare].density;
  if (!(max > min)) return min;
  const double width = (max - min) / kBins;
  std::vector<double> counts(kBins, 0.0);
  for (const Sample& sample : samples) {
    if (sample.change > *quarter || sample.density < min || sample.density > max) continue;
    counts[std::min(static_cast<std::size_t>((sample.density - min) / width), kBins - 1)] += 1;
  }
  std::size_t best = 0;
  double most = -1;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double blurred = 0;
    for (int by = -4 * kBlur; by <= 4 * kBlur; ++by) {
      const auto other = static_cast<std::ptrdiff_t>(bin) + by;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(kBins)) continue;
      blurred += counts[static_cast<std::size_t>(other)] * std::exp(-0.5 * by * by / (kBlur * kBlur));
    }
    if (blurred > most) {
      most = blurred;
      best = bin;
    }
  }
  return min + (static_cast<double>(best) + 0.5) * width;
}

// Densities of the materials.
struct Materials {
  // Most common densities around and in the bone; in a body, those of air and soft tissue.
  double around = 0;
  double bone = 0;
  // Density of water; set only for a body.
  std::optional<double> water;
};

Materials materials_of(std::span<const Sample> samples, bool in_hounsfield_units) {
  constexpr double kAirToSoftTissue_HU = 1030, kWithin_HU = 100, kSoftTissue_HU = 40;
  const std::size_t lower = lower_class(samples);
  Materials materials{commonest(samples.first(lower)), commonest(samples.subspan(lower)), std::nullopt};
  if (std::abs(materials.bone - materials.around - kAirToSoftTissue_HU) > kWithin_HU) return materials;
  const double off_HU = materials.bone - kSoftTissue_HU;
  const double water = in_hounsfield_units || std::abs(off_HU) < kWithin_HU ? 0 : off_HU;
  // A body has bone well above its soft tissue; a specimen whose air and bone are as far apart has little
  // above its most common density.
  const auto above = std::count_if(samples.begin(), samples.end(),
                                   [&](const Sample& sample) { return sample.density > water + kBone_HU; });
  if (static_cast<double>(above) > 0.03 * static_cast<double>(samples.size() - lower))
    materials.water = water;
  return materials;
}

// Scanners fill the corners outside their round field of view with a value far below air.
std::span<const Sample> without_lowest(std::span<const Sample> samples) {
  const auto others = std::find_if(samples.begin(), samples.end(), [&](const Sample& sample) {
    return sample.density > samples.front().density;
  });
  return {others, samples.end()};
}

// Ignores isolated noise voxels.
constexpr double kTouchingShare = 1e-3;

struct Range {
  double min;
  double max;
  bool holds(double isovalue) const { return isovalue < max && isovalue >= min; }
};

Range range_of(const DensityGrid& grid) {
  float min = grid[{0, 0, 0}], max = min;
  for_each_row(grid, [&](std::span<const float> row) {
    const auto [low, high] = std::minmax_element(row.begin(), row.end());
    min = std::min(min, *low);
    max = std::max(max, *high);
  });
  return {static_cast<double>(min), static_cast<double>(max)};
}

bool bone_touches(const DensityGrid& grid, double isovalue, std::size_t axis, int layer) {
  const auto& dims = grid.geometry().dims;
  const std::size_t across = (axis + 1) % 3, up = (axis + 2) % 3;
  long bone = 0;
  std::array<int, 3> v{};
  v[axis] = layer;
  for (v[across] = 0; v[across] < dims[across]; ++v[across])
    for (v[up] = 0; v[up] < dims[up]; ++v[up])
      bone += static_cast<double>(grid[{v[0], v[1], v[2]}]) > isovalue;
  return static_cast<double>(bone) > kTouchingShare * dims[across] * dims[up];
}

struct Choice {
  double value = 0;
  std::string how;
  // Halfway between two densities, because the scale of the densities is unknown.
  bool is_halfway = false;
};

// `samples` must ascend.
Choice isovalue_of_bone(std::span<const Sample> samples, bool in_hounsfield_units) {
  if (!(samples.back().density > samples.front().density)) {
    return {samples.front().density, "the only density in the scan"};
  }
  Materials found = materials_of(samples, in_hounsfield_units);
  const std::span<const Sample> unpadded = without_lowest(samples);
  if (!found.water && unpadded.back().density > unpadded.front().density) {
    const Materials other = materials_of(unpadded, in_hounsfield_units);
    if (other.water) found = other;
  }
  const double halfway = 0.5 * (found.around + found.bone);
  if (in_hounsfield_units && (found.water || halfway < kBone_HU) && samples.back().density > kBone_HU &&
      samples.front().density < kBone_HU) {
    return {kBone_HU, "lower limit of bone in Hounsfield units"};
  }
  if (found.water) {
    return {*found.water + kBone_HU,
            fmt::format("{:g} above water; the densities are spaced like Hounsfield units{}", kBone_HU,
                        *found.water == 0 ? "" : ", with a different zero")};
  }
  return {halfway,
          fmt::format("halfway between the most common densities, {:.4g} below and {:.4g} above",
                      found.around, found.bone),
          true};
}

constexpr std::size_t kLevels = 200;
using Curve = std::array<double, kLevels>;

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

// Mean gradient along the isosurface of a density.
struct Level {
  double density;
  double gradient;
};

bool is_less_sharp(const Level& a, const Level& b) {
  return a.gradient < b.gradient;
}

// Minimum gradient between a level and the next sharper one in the direction of `next`.
template <typename Way>
double min_before_sharper(const Level& from, Way next, Way end) {
  const Way sharper =
      std::find_if(next, end, [&](const Level& level) { return level.gradient > from.gradient; });
  return next == sharper ? from.gradient : std::min_element(next, sharper, is_less_sharp)->gradient;
}

// Reorders the samples.
std::vector<Boundary> boundaries_of(std::vector<Sample>& samples) {
  constexpr double kProminence = 0.1, kMinArea = 0.01;
  // Excludes outliers at both ends, which would only widen the levels.
  const auto rare = static_cast<std::ptrdiff_t>(samples.size() / 2000);
  const auto density_at = [&](std::ptrdiff_t rank) {
    std::nth_element(samples.begin(), samples.begin() + rank, samples.end(), is_less_dense);
    return samples[static_cast<std::size_t>(rank)].density;
  };
  const double min = density_at(rare), max = density_at(std::ssize(samples) - 1 - rare);
  if (!(max > min)) return {};
  const double width = (max - min) / kLevels;
  // The isosurface area is proportional to the sum of the gradient over the voxels between two levels.
  Curve area{}, gradient{};
  for (const Sample& sample : samples) {
    const double level = (sample.density - min) / width;
    if (!(level >= 0 && level <= kLevels)) continue;
    const auto n = std::min(static_cast<std::size_t>(level), kLevels - 1);
    const auto g = static_cast<double>(sample.gradient_per_mm);
    area[n] += g;
    gradient[n] += g * g;
  }
  area = blurred(area);
  gradient = blurred(gradient);
  const double min_area = kMinArea * *std::max_element(area.begin(), area.end());
  std::vector<Level> levels;
  for (std::size_t n = 0; n < kLevels; ++n) {
    if (area[n] > 0 && area[n] >= min_area)
      levels.push_back({min + (static_cast<double>(n) + 0.5) * width, gradient[n] / area[n]});
  }
  std::vector<std::vector<Level>::const_iterator> sharpest;
  for (auto level = levels.cbegin(); level != levels.cend(); ++level) {
    const double below = min_before_sharper(*level, std::make_reverse_iterator(level), levels.crend());
    const double above = min_before_sharper(*level, std::next(level), levels.cend());
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

}  // namespace

std::vector<Boundary> boundaries_in(const DensityGrid& grid) {
  std::vector<Sample> samples = samples_of(grid);
  return boundaries_of(samples);
}

namespace {

// Returns whether the isovalue belongs to the boundary. An isovalue halfway between two densities may be far
// from the sharpest density of the bone's boundary, and is then that of another one, such as the skin.
bool is_on_boundary(const Choice& chosen, const Boundary& boundary) {
  constexpr double kNear = 0.18;
  const double off = std::abs(chosen.value - boundary.density) / (boundary.above - boundary.below);
  return boundary.below < chosen.value && chosen.value < boundary.above &&
         (!chosen.is_halfway || off < kNear);
}

}  // namespace

SuggestedIsovalue suggest_isovalue(const DensityGrid& grid, bool in_hounsfield_units) {
  std::vector<Sample> samples = samples_of(grid);
  std::vector<Boundary> boundaries = boundaries_of(samples);
  std::sort(samples.begin(), samples.end(), is_less_dense);
  Choice chosen = isovalue_of_bone(samples, in_hounsfield_units);
  std::string others;
  for (Boundary& boundary : boundaries) {
    boundary.is_suggested = is_on_boundary(chosen, boundary);
    if (!boundary.is_suggested)
      others += fmt::format("{}{:.4g}", others.empty() ? "" : " and ", boundary.density);
  }
  if (!others.empty()) chosen.how += fmt::format("; a guess, with other boundaries at {}", others);
  return {chosen.value, std::move(chosen.how), std::move(boundaries)};
}

bool is_within(const DensityGrid& grid, double isovalue) {
  return range_of(grid).holds(isovalue);
}

std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue) {
  if (const Range range = range_of(grid); !range.holds(isovalue)) {
    return {fmt::format("the isovalue {:g} lies outside its values, {:g} to {:g}: {}", isovalue, range.min,
                        range.max, isovalue < range.min ? "all of it is bone" : "there is no bone")};
  }
  std::string faces;
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int layer : std::set{0, grid.geometry().dims[axis] - 1}) {
      if (!bone_touches(grid, isovalue, axis, layer)) continue;
      faces += fmt::format("{}{} {}", count++ == 0 ? "" : ", ", layer == 0 ? "first" : "last", "ijk"[axis]);
    }
  }
  if (count == 0) return {};
  return {fmt::format("bone touches the border of the volume ({}) and is cut off there", faces)};
}

DensityHistogram histogram_of(const DensityGrid& grid) {
  // Odd, so that the samples do not all come from the same columns.
  constexpr std::size_t kEnough = 1'000'000;
  std::vector<float> sample =
      every_nth_density(grid, std::max<std::size_t>(7, grid.geometry().voxel_count() / kEnough | 1));
  std::sort(sample.begin(), sample.end());
  const std::size_t rare = sample.size() / 2000;
  DensityHistogram histogram;
  histogram.min = sample[rare];
  histogram.max = std::max(sample[sample.size() - 1 - rare], histogram.min + 1);
  const float width = (histogram.max - histogram.min) / static_cast<float>(histogram.log_counts.size());
  for (const float density : sample) {
    const auto bin = static_cast<std::ptrdiff_t>((density - histogram.min) / width);
    if (bin >= 0 && bin < std::ssize(histogram.log_counts))
      histogram.log_counts[static_cast<std::size_t>(bin)] += 1;
  }
  for (float& count : histogram.log_counts) count = std::log1p(count);
  return histogram;
}

}  // namespace osteomill
