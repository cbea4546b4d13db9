#define AL_ALEXT_PROTOTYPES
#include <cmath>
#include <vector>

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <gtest/gtest.h>

#include "osteomill/visual/distance_beat.h"
#include "osteomill/visual/spindle_sound.h"

#include "tests/sound_brightness.h"

namespace osteomill {
namespace {

using testing_support::brightness;
using testing_support::strength;
using testing_support::TwoClasses;

constexpr int kRate_hz = SoundStream::kSampleRate_hz;
static_assert(kRate_hz == testing_support::kSoundRate_hz);

double strongest_hz(const std::vector<float>& sound) {
  double found_hz = 0;
  double max = 0;
  for (double frequency_hz = 100; frequency_hz < 1300; frequency_hz += 3) {
    const double here = strength(sound, frequency_hz);
    if (here <= max) continue;
    max = here;
    found_hz = frequency_hz;
  }
  return found_hz;
}

double rms(const std::vector<float>& sound) {
  double sum = 0;
  for (std::size_t n = sound.size() - kRate_hz / 2; n < sound.size(); ++n) {
    sum += static_cast<double>(sound[n]) * static_cast<double>(sound[n]);
  }
  return std::sqrt(sum / (kRate_hz / 2));
}

std::vector<float> computed(const SpindleState& state, std::size_t piece = 500) {
  SpindleSound sound(kRate_hz);
  std::vector<float> samples(3 * kRate_hz / 2);
  for (std::size_t n = 0; n < samples.size(); n += piece) {
    sound.render(state, std::span(samples).subspan(n, std::min(piece, samples.size() - n)));
  }
  return samples;
}

TEST(SpindleSound, PitchEqualsRevolutionsPerSecond) {
  for (const double speed_rpm : {15000.0, 40000.0, 60000.0}) {
    EXPECT_NEAR(strongest_hz(computed({speed_rpm, 0})), speed_rpm / 60, 4);
  }
}

TEST(SpindleSound, IsLouderUnderLoadAndLowerAtLowerSpeed) {
  const auto idle = computed({40000, 0});
  const auto loaded = computed({38000, 1});
  EXPECT_NEAR(strongest_hz(idle) - strongest_hz(loaded), 2000.0 / 60, 6);
  EXPECT_GT(rms(loaded), 2 * rms(idle));
  EXPECT_EQ(sound_load(0), 0);
  EXPECT_LT(sound_load(2), sound_load(20));
}

// Returns the fraction of runs classified correctly by a threshold learnt from other runs.
double classification_accuracy(const SpindleState& a, const SpindleState& b) {
  constexpr int kRuns = 16;
  TwoClasses learnt, tried;
  const auto varied = [](int run, int factor) { return (run * factor) % kRuns / static_cast<double>(kRuns); };
  for (int run = 0; run < kRuns; ++run) {
    for (const std::size_t kind : {0u, 1u}) {
      SpindleState state = kind == 0 ? a : b;
      state.speed_rpm *= 0.8 + 0.4 * varied(run, 7);
      state.load *= 0.7 + 0.6 * varied(run, 5);
      state.density *= 0.9 + 0.2 * varied(run, 11);
      const std::vector<float> sound = computed(state, static_cast<std::size_t>(100 + 37 * run));
      (run % 2 == 0 ? learnt : tried)[kind].push_back(brightness(sound, SpindleSound::pitch_hz(state)));
    }
  }
  return testing_support::classification_accuracy(learnt, tried);
}

TEST(SpindleSound, DistinguishesEnamelDentineAndBreakthrough) {
  EXPECT_GE(classification_accuracy({40000, 0.5, 1.0}, {40000, 0.5, 1.9}), 0.9);
  EXPECT_GE(classification_accuracy({40000, 0.5, 1.0}, {40000, 0.02, 0.2}), 0.9);
  // Sounds of the same kind must not be distinguishable.
  EXPECT_LE(classification_accuracy({40000, 0.5, 1.0}, {40000, 0.5, 1.0}), 0.7);
}

TEST(SpindleSound, DiamondBurrHissesMoreThanCuttingBurr) {
  const double cutting = brightness(computed({40000, 0.5, 1, false}), 40000.0 / 60);
  EXPECT_GT(brightness(computed({40000, 0.5, 1, true}), 40000.0 / 60), cutting + 0.3);
}

TEST(SpindleSound, IsSilentWhenOffAndNeverClips) {
  EXPECT_LT(rms(computed({0, 1})), 1e-6);
  for (const float sample : computed({120000, 1})) ASSERT_LT(std::abs(sample), 1.0f);
}

TEST(SpindleSound, IsIdenticalForAnyBlockSize) {
  EXPECT_EQ(computed({30000, 0.4}, 500), computed({30000, 0.4}, 77));
}

// Returns the start times of the beats.
std::vector<double> beats_of(const BeatState& state, int seconds) {
  std::vector<float> samples(static_cast<std::size_t>(seconds * kRate_hz));
  DistanceBeat(kRate_hz).add_to(state, samples);
  std::vector<double> begins_s;
  double silent_s = 1;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const bool sounds = std::abs(samples[n]) > 0.05f;
    if (sounds && silent_s > 0.015) begins_s.push_back(static_cast<double>(n) / kRate_hz);
    silent_s = sounds ? 0 : silent_s + 1.0 / kRate_hz;
  }
  return begins_s;
}

TEST(DistanceBeat, QuickensWithProximityAndHasPitchPerStructure) {
  EXPECT_EQ(beats_of(distance_beat(3.1, 3, 0), 2).size(), 0u);
  EXPECT_EQ(beats_of(distance_beat(std::nan(""), 3, 0), 2).size(), 0u);
  const auto slow = beats_of(distance_beat(2.99, 3, 0), 4), quick = beats_of(distance_beat(0.3, 3, 0), 4);
  EXPECT_NEAR(static_cast<double>(slow.size()), 4, 1);
  EXPECT_GT(quick.size(), 30u);
  EXPECT_LT(slow.front(), 0.02) << "a warning does not wait";
  // Contact is one long tone.
  EXPECT_EQ(beats_of(distance_beat(-0.1, 3, 0), 2).size(), 1u);
  EXPECT_GT(distance_beat(1, 3, 1).pitch_hz, 1.2 * distance_beat(1, 3, 0).pitch_hz);
}

// Returns the samples that OpenAL would send to a sound device.
std::vector<float> through_openal(const SpindleState& state) {
  ALCdevice* device = alcLoopbackOpenDeviceSOFT(nullptr);
  const ALCint format[] = {ALC_FORMAT_CHANNELS_SOFT,
                           ALC_MONO_SOFT,
                           ALC_FORMAT_TYPE_SOFT,
                           ALC_FLOAT_SOFT,
                           ALC_FREQUENCY,
                           kRate_hz,
                           0};
  ALCcontext* context = alcCreateContext(device, format);
  alcMakeContextCurrent(context);
  std::vector<float> heard(3 * kRate_hz / 2);
  {
    SoundStream stream;
    constexpr int kPiece = 350;
    for (std::size_t n = 0; n + kPiece <= heard.size(); n += kPiece) {
      stream.feed(state);
      alcRenderSamplesSOFT(device, heard.data() + n, kPiece);
    }
  }
  alcMakeContextCurrent(nullptr);
  alcDestroyContext(context);
  alcCloseDevice(device);
  return heard;
}

TEST(SoundStream, PitchFollowsSpeedThroughOpenAl) {
  for (const double speed_rpm : {20000.0, 50000.0}) {
    const auto heard = through_openal({speed_rpm, 0.1});
    EXPECT_NEAR(strongest_hz(heard), SpindleSound::pitch_hz({speed_rpm, 0.1}), 5);
    EXPECT_GT(rms(heard), 0.01);
  }
  EXPECT_LT(rms(through_openal({0, 0})), 1e-5);
}

TEST(SoundPlayer, DoesNotThrowWithoutAudioDevice) {
  SoundPlayer player;
  EXPECT_NO_THROW(player.set({40000, 0.5}));
}

}  // namespace
}  // namespace osteomill
