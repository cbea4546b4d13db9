#include "osteomill/study/study_design.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "osteomill/base/parse_number.h"
#include "osteomill/session/hand.h"

namespace osteomill {

namespace {

constexpr std::size_t kMaxTrials = 10'000'000;

std::vector<std::uint32_t> shuffled(std::size_t count, SeededRandom& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t n = count; n > 1; --n)
    std::swap(order[n - 1], order[static_cast<std::size_t>(random.uniform(0, static_cast<double>(n)))]);
  return order;
}

// The result does not depend on the order in which trials are requested.
double place_in_part(std::uint64_t seed, std::size_t axis, std::size_t trial) {
  return SeededRandom(seed * 0x9e3779b97f4a7c15 + axis * 0xbf58476d1ce4e5b9 + trial).uniform(0, 1);
}

}  // namespace

const std::string* find_value(const StudySettings& settings, std::string_view key) {
  const auto last = std::find_if(settings.rbegin(), settings.rend(),
                                 [&](const auto& setting) { return setting.first == key; });
  return last == settings.rend() ? nullptr : &last->second;
}

double StudyRange::at(double share) const {
  if (share <= 0) return from;
  if (share >= 1) return to;
  return logarithmic ? from * std::pow(to / from, share) : from + share * (to - from);
}

namespace {

// Rounds off errors in the last bits of a number for people: 4, not 3.9999999999999996.
double without_last_digits(double value) {
  if (value == std::floor(value)) return value;
  return parse_number<double>(fmt::format("{:.12g}", value)).value_or(value);
}

}  // namespace

std::vector<double> steps_of(const StudyRange& range, std::size_t steps) {
  if (steps == 0) throw std::invalid_argument("has no values");
  std::vector<double> values{range.from};
  const auto last = static_cast<double>(steps - 1);
  for (double n = 1; n < last; ++n) {
    values.push_back(without_last_digits(
        range.logarithmic ? range.at(n / last) : range.from + (range.to - range.from) * n / last));
  }
  if (steps > 1) values.push_back(range.to);
  return values;
}

std::vector<std::string> operands_of(std::string_view shown) {
  constexpr std::string_view kOver = " / ";
  const std::size_t over = shown.find(kOver);
  if (over == std::string_view::npos) return {std::string(shown)};
  return {std::string(shown.substr(0, over)), std::string(shown.substr(over + kOver.size()))};
}

StudyDesign::StudyDesign(StudySettings fixed, std::vector<StudyAxis> grid, LatinHypercube hypercube)
    : fixed_(std::move(fixed)), grid_(std::move(grid)), hypercube_(std::move(hypercube)) {
  const auto times = [&](std::size_t values) {
    if (values == 0) throw std::invalid_argument("an axis has no values");
    if (values > kMaxTrials / count_)
      throw std::invalid_argument(fmt::format("has more than {} trials", kMaxTrials));
    count_ *= values;
  };
  const auto varies = [&](const StudyAxis& axis) {
    const std::size_t before = varied_.size();
    for (const StudySettings& value : axis) {
      for (const auto& [key, text] : value) {
        const auto known = std::find(varied_.begin(), varied_.end(), key) - varied_.begin();
        if (known < static_cast<std::ptrdiff_t>(before)) throw std::invalid_argument(key + " varies twice");
        if (known == std::ssize(varied_)) varied_.push_back(key);
      }
    }
  };
  if (!hypercube_.axes.empty()) times(hypercube_.trials);
  SeededRandom random(hypercube_.seed);
  for (const LatinHypercube::Axis& axis : hypercube_.axes) {
    parts_.push_back(shuffled(hypercube_.trials, random));
    varies(axis.values.empty() ? StudyAxis{{{axis.key, ""}}} : axis.values);
  }
  for (const StudyAxis& axis : grid_) {
    times(axis.size());
    varies(axis);
  }
}

StudySettings StudyDesign::trial(std::size_t number) const {
  StudySettings settings = fixed_;
  const auto add = [&](const StudySettings& value) {
    settings.insert(settings.end(), value.begin(), value.end());
  };
  const std::size_t samples = hypercube_.axes.empty() ? 1 : hypercube_.trials;
  std::size_t each = count_ / samples;
  const std::size_t sample = number / each;
  std::size_t left = number % each;
  for (std::size_t n = 0; n < hypercube_.axes.size(); ++n) {
    const LatinHypercube::Axis& axis = hypercube_.axes[n];
    if (!axis.values.empty()) {
      add(axis.values[parts_[n][sample] * axis.values.size() / samples]);
      continue;
    }
    const double share =
        (parts_[n][sample] + place_in_part(hypercube_.seed, n, sample)) / static_cast<double>(samples);
    settings.emplace_back(axis.key, fmt::format("{}", axis.range.at(share)));
  }
  for (const StudyAxis& axis : grid_) {
    each /= axis.size();
    add(axis[left / each]);
    left %= each;
  }
  return settings;
}

std::string StudyDesign::label_of(const std::string& option) const {
  const std::string* unit = find_value(units, option);
  return unit == nullptr || unit->empty() ? option : fmt::format("{} ({})", option, *unit);
}

std::uint64_t seed_of(const StudySettings& settings) {
  const std::string* seed = find_value(settings, "seed");
  return seed == nullptr ? 1 : std::stoull(*seed);
}

}  // namespace osteomill
