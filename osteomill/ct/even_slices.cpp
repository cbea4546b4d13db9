#include "osteomill/ct/even_slices.h"

#include <algorithm>
#include <utility>

namespace osteomill {

void even_out_slices(SliceStack& stack, std::vector<float>& densities) {
  if (stack.heights_mm.empty()) return;
  const std::vector<double> heights_mm = std::exchange(stack.heights_mm, {});
  const std::size_t slice_size = densities.size() / heights_mm.size();
  std::vector<float> even;
  even.reserve(stack.geometry.voxel_count());
  for (int k = 0; k < stack.geometry.dims[2]; ++k) {
    const double height_mm = stack.geometry.spacing_mm.z() * k;
    const auto above = std::clamp(std::upper_bound(heights_mm.begin(), heights_mm.end(), height_mm),
                                  heights_mm.begin() + 1, heights_mm.end() - 1);
    const double share = std::clamp((height_mm - above[-1]) / (above[0] - above[-1]), 0.0, 1.0);
    const float* const lower =
        densities.data() + static_cast<std::size_t>(above - heights_mm.begin() - 1) * slice_size;
    const float* const upper = lower + slice_size;
    for (std::size_t n = 0; n < slice_size; ++n) {
      even.push_back(static_cast<float>((1 - share) * static_cast<double>(lower[n]) +
                                        share * static_cast<double>(upper[n])));
    }
  }
  densities = std::move(even);
}

}  // namespace osteomill
