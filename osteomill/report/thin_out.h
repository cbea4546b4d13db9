#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// The indices of a curve's samples that a drawing about `bins` pixels wide needs: of each of `bins` equal
/// parts the least and the greatest sample, in order, so that no spike is lost. All indices where there are
/// few samples.
std::vector<std::size_t> thin_out_curve(std::span<const double> values, std::size_t bins);

/// The same for a cloud of unit directions: of each part its first sample and the one farthest from `centre`.
std::vector<std::size_t> thin_out_cloud(std::span<const Vec3> directions, const Vec3& centre,
                                        std::size_t bins);

}  // namespace osteomill
