#include "osteomill/report/thin_out.h"

#include <algorithm>
#include <numeric>

namespace osteomill {

namespace {

// Two indices of each bin, as `pick(first, last)` chooses them.
template <typename Pick>
std::vector<std::size_t> two_of_each(std::size_t count, std::size_t bins, Pick pick) {
  std::vector<std::size_t> kept;
  if (count <= 2 * bins) {
    kept.resize(count);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  kept.reserve(2 * bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto [a, b] = pick(bin * count / bins, (bin + 1) * count / bins);
    kept.push_back(std::min(a, b));
    if (a != b) kept.push_back(std::max(a, b));
  }
  return kept;
}

}  // namespace

std::vector<std::size_t> thin_out_curve(std::span<const double> values, std::size_t bins) {
  return two_of_each(values.size(), bins, [&](std::size_t first, std::size_t last) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(last);
    const auto [min, max] = std::minmax_element(begin, end);
    return std::pair(static_cast<std::size_t>(min - values.begin()),
                     static_cast<std::size_t>(max - values.begin()));
  });
}

std::vector<std::size_t> thin_out_cloud(std::span<const Vec3> directions, const Vec3& centre,
                                        std::size_t bins) {
  return two_of_each(directions.size(), bins, [&](std::size_t first, std::size_t last) {
    std::size_t farthest = first;
    for (std::size_t n = first; n < last; ++n) {
      if ((directions[n] - centre).squaredNorm() > (directions[farthest] - centre).squaredNorm())
        farthest = n;
    }
    return std::pair(first, farthest);
  });
}

}  // namespace osteomill
