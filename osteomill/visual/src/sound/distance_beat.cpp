#include "osteomill/visual/distance_beat.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteomill {

namespace {

constexpr double kSlowest_per_s = 1, kFastest_per_s = 10;
// At this rate the beats merge into a continuous tone.
constexpr double kTouching_per_s = 1000;
constexpr double kBeat_s = 0.06;
constexpr double kLoudness = 0.18;
constexpr double kLoudnessRate_per_s = 250;

}  // namespace

BeatState distance_beat(double distance_mm, double warn_mm, std::size_t structure) {
  // Chord tones a third or more apart.
  constexpr double kPitches_hz[] = {660, 880, 1109, 1319, 1760};
  BeatState beat{0, kPitches_hz[structure % std::size(kPitches_hz)]};
  if (distance_mm <= 0) {
    beat.beats_per_s = kTouching_per_s;
  } else if (distance_mm < warn_mm) {
    beat.beats_per_s = kFastest_per_s + (kSlowest_per_s - kFastest_per_s) * distance_mm / warn_mm;
  }
  return beat;
}

void DistanceBeat::add_to(const BeatState& state, std::span<float> samples) {
  const double share = 1 - std::exp(-kLoudnessRate_per_s / sample_rate_hz_);
  for (float& sample : samples) {
    // The first beat starts immediately.
    beat_phase_ = state.beats_per_s > 0 ? beat_phase_ + state.beats_per_s / sample_rate_hz_ : 0;
    beat_phase_ -= std::floor(beat_phase_);
    const bool sounds = state.beats_per_s > 0 && beat_phase_ < kBeat_s * state.beats_per_s;
    loudness_ += share * ((sounds ? kLoudness : 0.0) - loudness_);
    phase_turns_ += state.pitch_hz / sample_rate_hz_;
    phase_turns_ -= std::floor(phase_turns_);
    sample += static_cast<float>(loudness_ * std::sin(2 * std::numbers::pi * phase_turns_));
  }
}

}  // namespace osteomill
