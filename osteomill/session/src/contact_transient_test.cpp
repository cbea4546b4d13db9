#include "osteomill/session/contact_transient.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr double kTick_s = 1e-3;

// A passive mass of 0.1 kg that hits a spring wall of 1 N/mm at z = 0 without friction.
struct Bounce {
  std::vector<double> transient_N;
  double given_Nmm = 0;
  double rebound_mm_s = 0;
};

Bounce bounce(const ContactTransientSettings& settings, double speed_mm_s) {
  constexpr double kMass_kg = 0.1;
  ContactTransient transient(settings);
  Bounce result;
  double z_mm = 0.1 * speed_mm_s, v_mm_s = -speed_mm_s;
  for (int n = 0; n < 1000; ++n) {
    const double wall_N = std::max(0.0, -z_mm);
    const Vec3 force_N = transient.force_N({{0, 0, z_mm}, Quat::Identity()}, {0, 0, wall_N}, kTick_s);
    result.transient_N.push_back(force_N.z());
    v_mm_s += 1000 * (wall_N + force_N.z()) / kMass_kg * kTick_s;
    z_mm += v_mm_s * kTick_s;
    result.given_Nmm += force_N.z() * v_mm_s * kTick_s;
  }
  result.rebound_mm_s = v_mm_s;
  return result;
}

double largest_N(const Bounce& bounce) {
  return *std::ranges::max_element(bounce.transient_N);
}

TEST(ContactTransient, GrowsWithImpactSpeedUpToItsLimit) {
  const ContactTransientSettings settings{.on = true};
  EXPECT_EQ(largest_N(bounce({}, 50)), 0);
  EXPECT_EQ(largest_N(bounce(settings, 4)), 0);
  const double slow_N = largest_N(bounce(settings, 20));
  EXPECT_GT(slow_N, 0.03);
  EXPECT_NEAR(largest_N(bounce(settings, 40)) / slow_N, 2, 0.01);
  EXPECT_LT(largest_N(bounce(settings, 400)), settings.max_N);
}

TEST(ContactTransient, TakesEnergyFromTheHandAtEverySpeed) {
  const ContactTransientSettings settings{.on = true};
  for (const double speed_mm_s : {6.0, 20.0, 50.0, 100.0, 200.0, 400.0}) {
    const Bounce with = bounce(settings, speed_mm_s), without = bounce({}, speed_mm_s);
    EXPECT_LT(with.given_Nmm, 0) << speed_mm_s;
    EXPECT_LT(with.rebound_mm_s, without.rebound_mm_s) << speed_mm_s;
    EXPECT_GE(*std::ranges::min_element(with.transient_N), 0) << speed_mm_s;
  }
}

TEST(ContactTransient, StartsSmallOscillatesAndEndsWithin20Milliseconds) {
  const Bounce hit = bounce({.on = true}, 100);
  const auto first = std::ranges::find_if(hit.transient_N, [](double force_N) { return force_N > 0; });
  // Zero in the tick of the contact; then less than half of the amplitude.
  EXPECT_LT(*first, 0.25);
  const std::vector<double> burst(first, first + 20);
  EXPECT_LT(burst[4], 0.01 * burst[1]);  // one swing of 5 ms
  EXPECT_GT(burst[6], 10 * burst[4]);
  EXPECT_LT(burst[6], burst[1]);
  EXPECT_TRUE(std::all_of(first + 20, hit.transient_N.end(), [](double force_N) { return force_N == 0; }));
}

TEST(ContactTransient, IsZeroForContactsInQuickSuccession) {
  ContactTransient transient({.on = true});
  double z_mm = 5;
  const auto tick = [&](double contact_N) {
    z_mm -= 0.05;
    return transient.force_N({{0, 0, z_mm}, Quat::Identity()}, {0, 0, contact_N}, kTick_s).norm();
  };
  for (int n = 0; n < 40; ++n) EXPECT_EQ(tick(0), 0);
  double first_N = 0;
  for (int n = 0; n < 25; ++n) first_N = std::max(first_N, tick(1));
  EXPECT_GT(first_N, 0.1);
  for (int n = 0; n < 200; ++n) EXPECT_EQ(tick(n % 10 < 5 ? 0 : 1), 0);
}

// Difference of a session's wrench with and without the transient while plunging onto flat bone.
TEST(ContactTransient, ChangesSessionForceForAtMost21Ticks) {
  const auto wrenches = [](bool on) {
    MillingSetup setup;
    setup.tick_s = kTick_s;
    setup.contact_transient.on = on;
    const auto bone = std::make_shared<Volume>(testing_support::shape_volume(
        testing_support::centred_cube(40, 0.25), testing_support::plane(Vec3::Zero(), Vec3::UnitZ())));
    MillingSession session(bone, {0, 1000}, setup);
    std::vector<TrajectoryPoint> plunge;
    for (int n = 0; n < 200; ++n)
      plunge.push_back({n * kTick_s, {{0, 0, std::max(0.2, 5 - 0.05 * n)}, Quat::Identity()}, false});
    std::vector<TickRecord> records;
    replay(session, plunge, [&](const TickRecord& record) { records.push_back(record); });
    return records;
  };
  const std::vector<TickRecord> with = wrenches(true), without = wrenches(false);
  int differing = 0;
  double largest_N = 0;
  for (std::size_t n = 0; n < with.size(); ++n) {
    const Vec3 difference_N = with[n].wrench.force_N - without[n].wrench.force_N;
    differing += difference_N.norm() > 0 ? 1 : 0;
    largest_N = std::max(largest_N, difference_N.norm());
    EXPECT_GE(difference_N.z(), -1e-9) << n;
  }
  EXPECT_GT(largest_N, 0.05);
  EXPECT_GT(differing, 5);
  EXPECT_LE(differing, 21);
}

}  // namespace
}  // namespace osteomill
