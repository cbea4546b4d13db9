#include "osteomill/surface/vertex_label.h"

#include <Eigen/Core>

namespace osteomill {

LabelMap::Place label_below(const LabelMap& labels, const MeshVertex& vertex) {
  const Vec3 point_W = Eigen::Map<const Eigen::Vector3f>(vertex.position_mm.data()).cast<double>();
  const Vec3 normal_W = Eigen::Map<const Eigen::Vector3f>(vertex.normal.data()).cast<double>();
  const double voxel_mm = labels.scan_geometry().spacing_mm.maxCoeff();
  for (const double voxels : {0.5, 0.0, 1.0, 1.5}) {
    const LabelMap::Place place = labels.nearest_to(point_W - voxels * voxel_mm * normal_W);
    if (place != 0) return place;
  }
  return 0;
}

}  // namespace osteomill
