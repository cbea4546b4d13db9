#pragma once

#include <array>
#include <span>
#include <vector>

#include "osteomill/tool/milling_tool.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// A place where a tool touches bone, or would within a short way: the tool's point there, the bone's outward
/// unit normal, and the way left between the two along it (negative where they overlap). In W.
struct ToolContact {
  Vec3 point_W;
  Vec3 normal_W;
  double gap_mm = 0;
};

/// Finds where the burr's sphere and the free shaft are near bone, from outside it. Rays go out from the
/// burr's centre through its vertices, and from the middle of each ring of the shaft through the ring's
/// vertices; where one meets bone, a few more rays close in on the nearest point of the surface. A ray that
/// starts in bone finds nothing.
class SurfaceContacts {
 public:
  /// `rings` circles along the free shaft. The burr may stand `bite_mm` deep in bone before a contact counts
  /// as overlap. Allocates.
  void prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm);
  /// The most contacts that `find` can give. Safe in the haptic tick.
  std::size_t capacity() const { return contacts_.capacity(); }
  /// The contacts within `kReach_mm` of the tool at `X_WT`, until the next call. Safe in the haptic tick.
  std::span<const ToolContact> find(const Pose& X_WT);

  /// How far from the tool's surface bone is noticed.
  static constexpr double kReach_mm = 0.3;

 private:
  void find_at_sphere(const Pose& X_WT);
  void find_at_rings(const Pose& X_WT);
  bool is_known(const Vec3& direction_W) const;
  void look_along(const Vec3& centre_W, const Vec3& direction_W, double radius_mm, double bite_mm,
                  const Vec3* axis_W);

  const Volume* volume_ = nullptr;
  MillingTool tool_;
  double bite_mm_ = 0;
  std::vector<Vec3> sphere_T_;
  std::vector<Vec3> ring_centres_T_;
  // The same for all rings: from the centre to each vertex.
  std::array<Vec3, kSliceVertices> ring_arms_T_;
  std::vector<ToolContact> contacts_;
  std::size_t first_of_part_ = 0;
};

}  // namespace osteomill
