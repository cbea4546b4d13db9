#include "osteomill/ct/volume_file.h"

#include "osteomill/ct/finite_densities.h"
#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

struct Details {
  const char* name;
  VolumeHeader (*check)(const fs::path&);
};

Details details_of(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::nrrd:
      return {"NRRD", check_nrrd};
    case VolumeFormat::metaimage:
      return {"MetaImage", check_metaimage};
    default:
      return {"NIfTI", check_nifti};
  }
}

GridGeometry geometry_of(const std::string& subject, const ItkImage& image, const VolumeHeader& header) {
  GridGeometry geometry;
  geometry.dims = header.dims;
  geometry.spacing_mm = Vec3(image.spacing.data()) * header.unit_mm;
  geometry.origin_mm = Vec3(image.origin.data()) * header.unit_mm;
  Mat3 axes;
  for (int axis = 0; axis < 3; ++axis)
    axes.col(axis) = Vec3(image.axes[static_cast<std::size_t>(axis)].data());
  check_axes(subject, axes);
  check_spacing(subject, {geometry.spacing_mm.x(), geometry.spacing_mm.y(), geometry.spacing_mm.z()});
  geometry.direction = axes.colwise().normalized();
  return geometry;
}

}  // namespace

Scan read_volume_file(const fs::path& path, VolumeFormat format) {
  const std::string subject = path.string();
  const Details details = details_of(format);
  VolumeHeader header = details.check(path);
  ItkImage image = read_itk_image(subject, format, header.dims);
  const GridGeometry geometry = header.geometry ? *header.geometry : geometry_of(subject, image, header);
  check_finite(subject, image.values);
  if (header.added_by_itk != 0) {
    for (float& value : image.values) value -= static_cast<float>(header.added_by_itk);
  }
  return {DensityGrid(geometry, std::move(image.values)), subject, details.name, std::move(header.warnings)};
}

}  // namespace osteomill
