#include "osteomill/haptics/line_proxy/shaft_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

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

std::vector<ShaftContact> contacts_of(const Volume& bone, const Pose& X_WL, const Pose& X_WL_before) {
  const ShaftContacts found = shaft_contacts(bone, kSpan, X_WL, X_WL_before, NormalRule{}, 0.5);
  return {found.all.begin(), found.all.begin() + static_cast<std::ptrdiff_t>(found.count)};
}
// Where nothing is known of where it came from.
std::optional<ShaftContact> contact_of(const Volume& bone, const Pose& X_WL) {
  const std::vector<ShaftContact> found = contacts_of(bone, X_WL, X_WL);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

// The first of each stretch's.
std::vector<ShaftContact> apexes_of(const Volume& bone, const Pose& X_WL) {
  std::vector<ShaftContact> apexes;
  const std::vector<ShaftContact> found = contacts_of(bone, X_WL, X_WL);
  for (std::size_t n = 0; n < found.size(); n += 1 + ShaftContacts::kPlaces) apexes.push_back(found[n]);
  return apexes;
}

// Bone where x > 0 and z > 0: an edge along y.
Volume quarter() {
  return shape_volume(centred_cube(64, 0.25), [](const Vec3& p) { return std::max(-p.x(), -p.z()); });
}

TEST(ShaftContact, AFreeLineHasNone) {
  EXPECT_FALSE(contact_of(quarter(), line({-1, 0, -3}, {0, 0, 1})));
}

TEST(ShaftContact, OnAnEdgeItIsTheEdgeAndLeadsAcrossEdgeAndLine) {
  const Volume bone = quarter();
  for (const Vec3& direction : {Vec3(-0.4, 0, 1), Vec3(-1, 0, 1), Vec3(-0.8, 0.6, 1), Vec3(-1, -1, 0.6)}) {
    const Vec3 along = direction.normalized();
    const Vec3 out = along.cross(Vec3::UnitY()).normalized() * -1.0;
    const Vec3 expected_out = out.dot(Vec3(-1, 0, -1)) > 0 ? out : Vec3(-out);
    constexpr double kLever_mm = 4.0;
    constexpr double kDepth_mm = 0.5;
    const auto contact = contact_of(bone, line(-kLever_mm * along - kDepth_mm * expected_out, along));
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->lever_mm, kLever_mm, 0.08) << direction.transpose();
    EXPECT_GT(contact->out_W.dot(expected_out), 0.998) << direction.transpose();
    EXPECT_NEAR(contact->depth_mm, kDepth_mm, 0.1) << direction.transpose();
  }
}

// A line that moves by a little may not make its contact leap: deeper and along a rough wall that it meets at
// a small angle and that ends below its end.
TEST(ShaftContact, MovesSmoothlyWithTheLine) {
  const Volume bone = shape_volume(centred_cube(96, 0.25), [](const Vec3& p) {
    return std::max(-p.x() + 0.03 * std::sin(5.0 * p.y()) + 0.03 * std::sin(4.0 * p.z()), p.z() - 2.0);
  });
  std::optional<ShaftContact> before;
  for (int n = 0; n <= 100; ++n) {
    std::optional<ShaftContact> contact;
    for (const ShaftContact& one : apexes_of(bone, line({0.004 * n - 0.1, 0.01 * n, -4}, {0.08, 0, 1}))) {
      const double near_mm = before ? before->lever_mm : 0.0;
      if (!contact || std::abs(one.lever_mm - near_mm) < std::abs(contact->lever_mm - near_mm)) contact = one;
    }
    ASSERT_TRUE(contact);
    EXPECT_GT(contact->out_W.dot(-Vec3::UnitX()), 0.97);
    if (before) {
      EXPECT_LT(std::abs(contact->lever_mm - before->lever_mm), 0.2) << n;
      EXPECT_LT(std::abs(contact->depth_mm - before->depth_mm), 0.02) << n;
      EXPECT_LT((contact->out_W - before->out_W).norm(), 0.05) << n;
    }
    before = contact;
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
  const auto contact = contact_of(bone, line(tip_W, along));
  ASSERT_TRUE(contact);
  EXPECT_GT(contact->out_W.dot(normal), 0.998);
  EXPECT_NEAR(contact->lever_mm, kSpan.end_mm, 0.1);
  EXPECT_NEAR(contact->depth_mm, 0.4, 0.05);
}

TEST(ShaftContact, EachStretchInBoneHasItsOwn) {
  // Two bars across the line, at 2 and at 6 mm, on either side of it.
  const Volume bone = shape_volume(centred_cube(96, 0.25), [](const Vec3& p) {
    const double low = std::max(std::abs(p.z() - 2.0) - 0.8, p.x() - 0.3);
    const double high = std::max(std::abs(p.z() - 6.0) - 0.8, -p.x() - 0.3);
    return std::min(low, high);
  });
  const Pose X_WL = line(Vec3::Zero(), Vec3::UnitZ());
  const std::vector<ShaftContact> found = contacts_of(bone, X_WL, X_WL);
  ASSERT_EQ(found.size(), 2 * (1 + ShaftContacts::kPlaces));
  const ShaftContact& low = found[0];
  const ShaftContact& high = found[1 + ShaftContacts::kPlaces];
  EXPECT_NEAR(low.lever_mm, 2.0, 0.2);
  EXPECT_GT(low.out_W.x(), 0.98);
  EXPECT_NEAR(high.lever_mm, 6.0, 0.2);
  EXPECT_LT(high.out_W.x(), -0.98);
}

// A wall 1 mm thick that the line goes straight through, up to 0.2 mm from the wall's edge.
TEST(ShaftContact, ThroughAThinWallItLeadsBackToWhereTheLineWasFree) {
  const Volume bone = shape_volume(centred_cube(64, 0.25), [](const Vec3& p) {
    return std::max(std::abs(p.z() - 3.0) - 0.5, p.x() - 0.2);
  });
  const Pose X_WL = line(Vec3::Zero(), Vec3::UnitZ());
  const std::vector<ShaftContact> found = contacts_of(bone, X_WL, line({0.25, 0, 0}, Vec3::UnitZ()));
  ASSERT_FALSE(found.empty());
  EXPECT_GT(found[0].out_W.x(), 0.98);
  EXPECT_NEAR(found[0].depth_mm, 0.2, 0.05);
  EXPECT_NEAR(found[0].lever_mm, 3.0, 0.1);
}

}  // namespace
}  // namespace osteomill::line_proxy
