#pragma once

#include <span>
#include <vector>

#include "osteomill/haptics/surface_points/ray_contacts.h"

namespace osteomill::surface_points {

/// A tool that follows the device as far as the bone lets it: a god-object with six degrees of freedom. Each
/// step it goes to the pose nearest to the device's that overlaps no bone, as far as that is known from where
/// it stands (the contacts' tangent planes), without friction, and never further than it can see. Near bone
/// it looks again where it is about to go, and takes what it meets there into account.
class HeldTool {
 public:
  /// `rings` circles stand for the shaft; the burr rests `bite_mm` deep in bone. Allocates.
  void prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm);
  /// Forgets where it was: the next `follow` starts at the device.
  void reset() { placed_ = false; }
  /// Safe in the haptic tick.
  const Pose& follow(const Pose& X_WD);

  /// The longest way that a point of the tool goes between two looks at the bone; less than the contacts'
  /// reach.
  static constexpr double kStride_mm = 0.2;
  /// So many strides a step at most: 1.6 m/s at 1 kHz.
  static constexpr int kStrides = 8;

 private:
  // A move of the tool in W: of its origin, and a rotation vector about it.
  struct Move {
    Vec3 shift_mm = Vec3::Zero();
    Vec3 turn_rad = Vec3::Zero();
  };
  // A contact as it limits a move: along . shift + about . turn >= -gap.
  struct Limit {
    Vec3 along;
    Vec3 about;
    double gap_mm = 0;
    double response = 0;
    double push = 0;
  };
  // How a stride ended: as near to the device as the bone lets it, or cut short on its way, with or without
  // bone in that way.
  enum class Stride : unsigned char { arrived, free, pushed };
  Stride stride(const Pose& X_WD);
  bool add_limits(std::span<const RayContact> contacts, const Move& at, const Pose& X_WT);
  double travel_mm(const Move& move) const;
  Pose after(const Move& move) const;
  bool limit_move(Move& move);
  Move limited(const Move& wanted, bool& pushed);

  RayContacts contacts_;
  std::vector<Limit> limits_;
  double length_mm_ = 0;
  // What a turn costs against a shift, mm^2: the square of half the tool's length.
  double turn_weight_mm2_ = 1;
  Pose X_WT_;
  bool placed_ = false;
};

}  // namespace osteomill::surface_points
