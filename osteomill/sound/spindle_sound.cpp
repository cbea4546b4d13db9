#include "osteomill/sound/spindle_sound.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteomill {

namespace {

constexpr double kSecondsPerMinute = 60;
// A motor under full load gives way by this share.
constexpr double kSag = 0.08;
constexpr double kSpeedFollows_per_s = 9;
constexpr double kLoadFollows_per_s = 25;
constexpr double kIdleLoudness = 0.10;
constexpr double kLoadLoudness = 0.28;
constexpr double kNoiseLoudness = 0.22;
// Of the tone and its overtones, and once more of half of it: bearings are never quite round.
constexpr double kOvertones[] = {1.0, 0.45, 0.22, 0.10};
constexpr double kHalfTone = 0.12;

double sine(double turns) {
  return std::sin(2 * std::numbers::pi * turns);
}

}  // namespace

double SpindleSound::pitch_hz(const SpindleState& state) {
  return state.speed_rpm / kSecondsPerMinute * (1 - kSag * std::clamp(state.load, 0.0, 1.0));
}

float SpindleSound::noise() {
  noise_ = 1664525u * noise_ + 1013904223u;
  const float white = static_cast<float>(noise_ >> 8) / 8388608.0f - 1.0f;
  smooth_noise_ += 0.35f * (white - smooth_noise_);
  return smooth_noise_;
}

void SpindleSound::render(const SpindleState& state, std::span<float> samples) {
  const bool on = state.speed_rpm > 0;
  const double speed_share = 1 - std::exp(-kSpeedFollows_per_s / sample_rate_hz_);
  const double load_share = 1 - std::exp(-kLoadFollows_per_s / sample_rate_hz_);
  const double wanted_load = on ? std::clamp(state.load, 0.0, 1.0) : 0;
  for (float& sample : samples) {
    pitch_hz_ += speed_share * (pitch_hz(state) - pitch_hz_);
    loudness_ += speed_share * ((on ? 1.0 : 0.0) - loudness_);
    load_ += load_share * (wanted_load - load_);
    turns_ += pitch_hz_ / sample_rate_hz_;
    turns_ -= 2 * std::floor(0.5 * turns_);
    double tone = kHalfTone * sine(0.5 * turns_);
    double overtone = 1;
    for (const double share : kOvertones) {
      // What the samples cannot hold would come back as another tone.
      if (overtone * pitch_hz_ < 0.45 * sample_rate_hz_) tone += share * sine(overtone * turns_);
      overtone += 1;
    }
    const double hiss = kNoiseLoudness * load_ * static_cast<double>(noise());
    sample = static_cast<float>(loudness_ * ((kIdleLoudness + kLoadLoudness * load_) * tone + hiss));
  }
}

}  // namespace osteomill
