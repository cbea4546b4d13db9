#include "osteomill/milling/no_go_watch.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "osteomill/haptics/sample_points.h"

namespace osteomill {

NoGoWatch::NoGoWatch(std::shared_ptr<const LabelMap> labels, double burr_radius_mm)
    : labels_(std::move(labels)), radius_mm_(burr_radius_mm) {
  constexpr double kMinPoints = 64, kMaxPoints = 512;
  if (!labels_ || labels_->no_go_box().empty()) return;
  const double apart_mm = labels_->scan_geometry().spacing_mm.minCoeff();
  const double count = 4 * std::numbers::pi * radius_mm_ * radius_mm_ / (apart_mm * apart_mm);
  points_mm_ = spiral_directions(static_cast<int>(std::clamp(count, kMinPoints, kMaxPoints)));
  for (Vec3& point_mm : points_mm_) point_mm *= radius_mm_;
  points_mm_.push_back(Vec3::Zero());
}

void NoGoWatch::tally_contacts(const Vec3& burr_centre_W, LabelTally& tally) const noexcept {
  if (points_mm_.empty() || !burr_centre_W.allFinite()) return;
  const GridGeometry& scan = labels_->scan_geometry();
  const VoxelBox& box = labels_->no_go_box();
  const Vec3 centre = scan.voxel_from_world(burr_centre_W);
  const Vec3 reach = Vec3::Constant(radius_mm_).cwiseQuotient(scan.spacing_mm) + Vec3::Ones();
  const Vec3 first(box.first.i, box.first.j, box.first.k), last(box.last.i, box.last.j, box.last.k);
  if (((first - centre).array() > reach.array()).any() || ((centre - last).array() > reach.array()).any()) {
    return;
  }
  for (const Vec3& point_mm : points_mm_) {
    const LabelMap::LabelIndex label = labels_->nearest_to(burr_centre_W + point_mm);
    if (label != 0 && labels_->label(label).no_go) tally.add_contact(label);
  }
}

}  // namespace osteomill
