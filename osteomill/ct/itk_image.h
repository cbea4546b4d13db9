#pragma once

#include <array>
#include <string>
#include <vector>

namespace osteomill {

enum class VolumeFormat { nrrd, metaimage, nifti };

/// A volume as ITK reads it. Plain types only: ITK brings an Eigen of its own, which must not meet ours.
struct ItkImage {
  std::array<double, 3> spacing{1, 1, 1};
  std::array<double, 3> origin{0, 0, 0};
  /// The direction of each axis in LPS.
  std::array<std::array<double, 3>, 3> axes{};
  std::vector<float> values;
};

/// Throws InputError naming the file where it is not one grey volume of these dims or cannot be read.
/// The caller has checked that the file holds what its header promises.
ItkImage read_itk_image(const std::string& path, VolumeFormat format, const std::array<int, 3>& dims);

}  // namespace osteomill
