#include "osteomill/volume/isovalue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

struct Sample {
  double density;
  // Sum over the axes of the densities' difference across the voxel.
  double change;
};

constexpr double kMaxSamples = 4e6;

std::vector<Sample> samples_of(const DensityGrid& grid) {
  const auto& dims = grid.geometry().dims;
  const int step = static_cast<int>(
      std::ceil(std::cbrt(static_cast<double>(grid.geometry().voxel_count()) / kMaxSamples)));
  const auto at = [&](std::array<int, 3> v, std::size_t axis, int by) {
    v[axis] = std::clamp(v[axis] + by, 0, dims[axis] - 1);
    return static_cast<double>(grid[{v[0], v[1], v[2]}]);
  };
  std::vector<Sample> samples;
  for (int k = 0; k < dims[2]; k += step) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; j += step) {
      for (int i = 0; i < dims[0]; i += step) {
        double change = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
          change += std::abs(at({i, j, k}, axis, 1) - at({i, j, k}, axis, -1));
        samples.push_back({static_cast<double>(grid[{i, j, k}]), change});
      }
    }
  }
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.density < b.density; });
  return samples;
}

// Otsu 1979, eq. 18: how many of the samples, which ascend, are the lower of the two classes with the
// greatest variance between them. At least one is in each.
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

// The commonest density of the quarter that changes least from voxel to voxel.
double commonest(std::span<const Sample> samples) {
  constexpr std::size_t kBins = 1024;
  constexpr int kBlur = 10;
  std::vector<double> changes;
  for (const Sample& sample : samples) changes.push_back(sample.change);
  const auto quarter = changes.begin() + static_cast<std::ptrdiff_t>((changes.size() - 1) / 4);
  std::nth_element(changes.begin(), quarter, changes.end());
  // Without the rarest at both ends, which would only make the bins wide.
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

// What the densities are of, as far as they tell.
struct Materials {
  // The commonest density around the bone and in it; of a body, those of air and soft tissue.
  double around = 0;
  double bone = 0;
  // Of a body: where water lies.
  std::optional<double> water;
};

Materials materials_of(std::span<const Sample> samples, bool in_hounsfield_units) {
  constexpr double kAirToSoftTissue_HU = 1030, kWithin_HU = 100, kSoftTissue_HU = 40;
  const std::size_t lower = lower_class(samples);
  Materials materials{commonest(samples.first(lower)), commonest(samples.subspan(lower)), std::nullopt};
  if (std::abs(materials.bone - materials.around - kAirToSoftTissue_HU) > kWithin_HU) return materials;
  const double off_HU = materials.bone - kSoftTissue_HU;
  const double water = in_hounsfield_units || std::abs(off_HU) < kWithin_HU ? 0 : off_HU;
  // A body has bones; of a specimen with air and bone as far apart, little is above its commonest density.
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

// Single voxels of noise are no bone.
constexpr double kTouchingShare = 1e-3;

struct Range {
  double min;
  double max;
  bool holds(double isovalue) const { return isovalue < max && isovalue >= min; }
};

Range range_of(const CopyOnWriteFloats& densities) {
  constexpr std::size_t kAtOnce = 1 << 22;
  float min = densities.front(), max = min;
  for (std::size_t first = 0; first < densities.size(); first += kAtOnce) {
    const std::size_t last = std::min(first + kAtOnce, densities.size());
    const auto [low, high] = std::minmax_element(densities.begin() + first, densities.begin() + last);
    min = std::min(min, *low);
    max = std::max(max, *high);
    WorkProgress::done(first, 2 * densities.size());
  }
  return {static_cast<double>(min), static_cast<double>(max)};
}

bool touches(const DensityGrid& grid, double isovalue, std::size_t axis, int place) {
  const auto& dims = grid.geometry().dims;
  const std::size_t across = (axis + 1) % 3, up = (axis + 2) % 3;
  long bone = 0;
  std::array<int, 3> v{};
  v[axis] = place;
  for (v[across] = 0; v[across] < dims[across]; ++v[across])
    for (v[up] = 0; v[up] < dims[up]; ++v[up])
      bone += static_cast<double>(grid[{v[0], v[1], v[2]}]) > isovalue;
  return static_cast<double>(bone) > kTouchingShare * dims[across] * dims[up];
}

}  // namespace

namespace {

SuggestedIsovalue isovalue_of_bone(const DensityGrid& grid, bool in_hounsfield_units) {
  const std::vector<Sample> all = samples_of(grid);
  const std::span<const Sample> samples = all;
  if (!(samples.back().density > samples.front().density)) {
    return {samples.front().density, "the only density there is"};
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
    return {kBone_HU, "where bone begins in Hounsfield units"};
  }
  if (found.water) {
    return {*found.water + kBone_HU,
            fmt::format("{:g} above water; the densities are spaced as Hounsfield units are{}", kBone_HU,
                        *found.water == 0 ? "" : ", with another zero")};
  }
  return {halfway, fmt::format("halfway between the commonest densities, {:.4g} below and {:.4g} above",
                               found.around, found.bone)};
}

}  // namespace

SuggestedIsovalue suggest_isovalue(const DensityGrid& grid, bool in_hounsfield_units) {
  SuggestedIsovalue suggested = isovalue_of_bone(grid, in_hounsfield_units);
  suggested.boundaries = boundaries_in(grid);
  std::string others;
  for (const Boundary& boundary : suggested.boundaries) {
    if (boundary.below < suggested.value && suggested.value < boundary.above) continue;
    others += fmt::format("{}{:.4g}", others.empty() ? "" : " and ", boundary.density);
  }
  if (!others.empty()) suggested.how += fmt::format("; a guess, with other boundaries at {}", others);
  return suggested;
}

bool is_within(const DensityGrid& grid, double isovalue) {
  return range_of(grid.densities()).holds(isovalue);
}

std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue) {
  if (const Range range = range_of(grid.densities()); !range.holds(isovalue)) {
    return {fmt::format("the isovalue {:g} lies outside its values, {:g} to {:g}: {}", isovalue, range.min,
                        range.max, isovalue < range.min ? "all of it is bone" : "there is no bone")};
  }
  std::string faces;
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int place : {0, grid.geometry().dims[axis] - 1}) {
      if (!touches(grid, isovalue, axis, place)) continue;
      faces += fmt::format("{}{} {}", count++ == 0 ? "" : ", ", place == 0 ? "first" : "last", "ijk"[axis]);
    }
  }
  if (count == 0) return {};
  return {fmt::format("bone touches the border of the volume ({}) and is cut off there", faces)};
}

DensityHistogram histogram_of(const DensityGrid& grid) {
  // An odd number, so that not all come from the same columns.
  constexpr std::size_t kEnough = 1'000'000;
  const std::size_t every = std::max<std::size_t>(7, grid.densities().size() / kEnough | 1);
  std::vector<float> sample;
  for (std::size_t n = 0; n < grid.densities().size(); n += every) sample.push_back(grid.densities()[n]);
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
