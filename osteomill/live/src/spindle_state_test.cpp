#include "osteomill/live/spindle_state.h"

#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/session/milling_session.h"

#include "tests/pressing_device.h"
#include "tests/shapes.h"
#include "tests/sound_brightness.h"

namespace osteomill {
namespace {

using testing_support::TwoClasses;

constexpr int kRuns = 10;

// Densities of the built-in tooth; dentine is the reference.
constexpr BoneDensities kTooth{0, 1500};
constexpr double kDentine = 1500, kEnamel = 2800;

Volume tooth_plate(double density, double thickness_mm) {
  GridGeometry geometry = testing_support::centred_cube(48, 0.125);
  const Volume shape = testing_support::shape_volume(
      geometry, [&](const Vec3& p) { return std::max(p.z(), -p.z() - thickness_mm); });
  std::vector<float> densities;
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    densities.push_back(static_cast<float>(density / 1000) * shape.grid()[v]);
  });
  return Volume(DensityGrid(geometry, std::move(densities)), 750);
}

// One of kRuns simulated hands.
struct Hand {
  int number;
  double varied(int factor) const { return (number * factor) % kRuns / static_cast<double>(kRuns); }
  double push_N() const { return 2 + varied(3); }
  double speed_rpm() const { return 36000 + 8000 * varied(7); }
};

struct Sounds {
  std::vector<float> cutting;
  // Times since the last contact with bone; empty if the burr never lost it.
  std::vector<float> through;
};

// Returns the sounds of a session that presses a burr into a plate.
Sounds heard(Volume bone, const Hand& hand, double max_s) {
  constexpr double kCutting_s = 0.5, kThrough_s = 1;
  MillingSetup setup;
  setup.law = CuttingLaw::chips;
  setup.cutting.spindle_speed_rpm = hand.speed_rpm();
  setup.guard = GuardSettings::for_simulation();
  MillingSession session(std::make_shared<Volume>(std::move(bone)), kTooth, setup);
  const double above_mm = setup.tool.burr_radius_mm + 0.02 + 0.1 * hand.varied(1);
  testing_support::PressingDevice device({{0, 0, above_mm}, Quat::Identity()}, -Vec3::UnitZ(), 25);
  device.press(hand.push_N());
  SpindleSound sound(testing_support::kSoundRate_hz);
  std::vector<float> all;
  Sounds sounds;
  double pressed_s = 0;
  for (int n = 0; 1e-3 * n < max_s && sounds.through.empty(); ++n) {
    const double time_s = 1e-3 * n;
    const TickRecord record = session.tick(device, {.time_s = time_s, .spindle_on = true});
    const auto before = static_cast<std::ptrdiff_t>(all.size());
    all.resize(static_cast<std::size_t>((time_s + 1e-3) * testing_support::kSoundRate_hz));
    sound.render(spindle_state(record, setup), std::span(all.begin() + before, all.end()));
    if (record.burr_force_W_N.norm() > 0 || time_s < kCutting_s) pressed_s = time_s;
    if (sounds.cutting.empty() && time_s >= kCutting_s) sounds.cutting = all;
    if (time_s - pressed_s > kThrough_s) sounds.through = all;
  }
  return sounds;
}

double bright(const std::vector<float>& sound, const Hand& hand) {
  return testing_support::brightness(sound, hand.speed_rpm() / 60);
}

// Returns the fraction of sounds classified correctly by a threshold learnt from other runs; `brightness`
// gives the brightness of both kinds in one run.
template <typename Brightness>
double classification_accuracy(const Brightness& brightness) {
  TwoClasses learnt, tried;
  for (int run = 0; run < kRuns; ++run) {
    const auto both = brightness(Hand{run});
    for (const std::size_t kind : {0u, 1u}) (run % 2 == 0 ? learnt : tried)[kind].push_back(both[kind]);
  }
  return testing_support::classification_accuracy(learnt, tried);
}

TEST(SpindleState, ASessionsSoundTellsEnamelFromDentine) {
  EXPECT_GE(classification_accuracy([](const Hand& hand) {
              const auto of = [&](double density) {
                return bright(heard(tooth_plate(density, 2), hand, 0.6).cutting, hand);
              };
              return std::array{of(kDentine), of(kEnamel)};
            }),
            0.9);
}

TEST(SpindleState, ASessionsSoundTellsBreakthroughFromCutting) {
  EXPECT_GE(classification_accuracy([](const Hand& hand) {
              const Sounds sounds = heard(tooth_plate(kDentine, 0.25), hand, 60);
              return std::array{bright(sounds.cutting, hand), bright(sounds.through, hand)};
            }),
            0.9);
}

}  // namespace
}  // namespace osteomill
