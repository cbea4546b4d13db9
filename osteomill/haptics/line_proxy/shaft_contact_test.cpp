#include "osteomill/haptics/line_proxy/shaft_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill::line_proxy {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr ShaftSpan kSpan{0.5, 8.0, 0.125};

// The line from `tip_W` along `direction`.
Pose line(const Vec3& tip_W, const Vec3& direction) {
  return {tip_W, smallest_rotation(Vec3::UnitZ(), direction)};
}

std::optional<ShaftContacts> contacts_of(const Volume& bone, const Pose& X_WL) {
  return shaft_contacts(bone, kSpan, X_WL, NormalRule{}, 0.5);
}
std::optional<ShaftContact> deepest_of(const Volume& bone, const Pose& X_WL) {
  const auto found = contacts_of(bone, X_WL);
  if (!found) return std::nullopt;
  return *std::max_element(found->begin(), found->end(),
                           [](const auto& a, const auto& b) { return a.depth_mm < b.depth_mm; });
}

// Bone where x > 0 and z > 0: an edge along y.
Volume quarter() {
  return shape_volume(centred_cube(64, 0.25), [](const Vec3& p) { return std::max(-p.x(), -p.z()); });
}

TEST(ShaftContact, AFreeLineHasNone) {
  EXPECT_FALSE(deepest_of(quarter(), line({-1, 0, -3}, {0, 0, 1})));
}

TEST(ShaftContact, OnAnEdgeItIsTheEdgeAndLeadsAcrossEdgeAndLine) {
  const Volume bone = quarter();
  for (const Vec3& direction : {Vec3(-0.4, 0, 1), Vec3(-1, 0, 1), Vec3(-0.8, 0.6, 1), Vec3(-1, -1, 0.6)}) {
    const Vec3 along = direction.normalized();
    const Vec3 out = along.cross(Vec3::UnitY()).normalized() * -1.0;
    const Vec3 expected_out = out.dot(Vec3(-1, 0, -1)) > 0 ? out : Vec3(-out);
    constexpr double kLever_mm = 4.0;
    constexpr double kDepth_mm = 0.3;
    const auto contact = deepest_of(bone, line(-kLever_mm * along - kDepth_mm * expected_out, along));
    ASSERT_TRUE(contact);
    // Half as far as its places lie apart.
    EXPECT_NEAR(contact->lever_mm, kLever_mm, 0.15) << direction.transpose();
    EXPECT_GT(contact->out_W.dot(expected_out), 0.998) << direction.transpose();
    EXPECT_NEAR(contact->depth_mm, kDepth_mm, 0.1) << direction.transpose();
  }
}

// The far end pushed into bone, as when the handle's side hits first: only the end is in, and the way out is
// the surface's normal, not across the shaft.
TEST(ShaftContact, AnEndInBoneLeavesAlongTheNormal) {
  const Vec3 normal = Vec3(0.1, -0.2, -1).normalized();
  const Volume bone = shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), normal));
  const Vec3 along = Vec3(0.3, 0, 1).normalized();
  // The end 0.4 mm deep.
  const Vec3 tip_W = -0.4 * normal - kSpan.end_mm * along;
  const auto contact = deepest_of(bone, line(tip_W, along));
  ASSERT_TRUE(contact);
  EXPECT_GT(contact->out_W.dot(normal), 0.998);
  EXPECT_NEAR(contact->lever_mm, kSpan.end_mm, 0.1);
  EXPECT_NEAR(contact->depth_mm, 0.4, 0.05);
}

TEST(ShaftContact, TheStretchNearestToTheTipIsTaken) {
  // Two bars across the line, at 2 and at 6 mm, on either side of it.
  const Volume bone = shape_volume(centred_cube(96, 0.25), [](const Vec3& p) {
    const double low = std::max(std::abs(p.z() - 2.0) - 0.8, p.x() - 0.3);
    const double high = std::max(std::abs(p.z() - 6.0) - 0.8, -p.x() - 0.3);
    return std::min(low, high);
  });
  const auto low = contacts_of(bone, line(Vec3::Zero(), Vec3::UnitZ()));
  ASSERT_TRUE(low);
  EXPECT_NEAR((*low)[low->size() / 2].lever_mm, 2.0, 0.2);
  EXPECT_GT((*low)[low->size() / 2].out_W.x(), 0.98);
  const auto high = contacts_of(bone, line(Vec3(0, 0, 3.5), Vec3::UnitZ()));
  ASSERT_TRUE(high);
  EXPECT_NEAR((*high)[high->size() / 2].lever_mm, 2.5, 0.2);
  EXPECT_LT((*high)[high->size() / 2].out_W.x(), -0.98);
}

// A wall 1 mm thick that the line goes straight through: its two surfaces look away from each other.
TEST(ShaftContact, StraightThroughAWallNoWayOutIsNear) {
  const Volume bone = shape_volume(centred_cube(64, 0.25), [](const Vec3& p) {
    return std::max(std::abs(p.z() - 3.0) - 0.5, p.x() - 2.0);
  });
  const auto found = contacts_of(bone, line(Vec3::Zero(), Vec3::UnitZ()));
  ASSERT_TRUE(found);
  for (const ShaftContact& contact : *found) EXPECT_TRUE(std::isinf(contact.depth_mm));
}

}  // namespace
}  // namespace osteomill::line_proxy
