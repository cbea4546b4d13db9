#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace osteomill::testing_support {

inline constexpr int kSoundRate_hz = 44100;

/// Returns the amplitude of one frequency in the last quarter of a second, as an unnormalised Fourier sum.
inline double strength(const std::vector<float>& sound, double frequency_hz) {
  double cosine = 0;
  double sine = 0;
  for (std::size_t n = sound.size() - kSoundRate_hz / 4; n < sound.size(); ++n) {
    const double angle = 2 * std::numbers::pi * frequency_hz * static_cast<double>(n) / kSoundRate_hz;
    cosine += static_cast<double>(sound[n]) * std::cos(angle);
    sine += static_cast<double>(sound[n]) * std::sin(angle);
  }
  return std::hypot(cosine, sine);
}

/// Returns the logarithm of the power in a band around 4 kHz relative to the tone's, in the last quarter of a
/// second.
inline double brightness(const std::vector<float>& sound, double tone_hz) {
  double band = 0;
  for (double frequency_hz = 3600; frequency_hz <= 4400; frequency_hz += 16)
    band += std::pow(strength(sound, frequency_hz), 2);
  double tone = 0;
  for (double off_hz = -8; off_hz <= 8; off_hz += 4) tone += std::pow(strength(sound, tone_hz + off_hz), 2);
  return std::log(band / tone);
}

/// One feature value per sound, for two classes of sounds.
using TwoClasses = std::array<std::vector<double>, 2>;

/// Returns the share of `tried` classified correctly by the threshold midway between the class means of
/// `learnt`.
inline double classification_accuracy(const TwoClasses& learnt, const TwoClasses& tried) {
  const auto mean_of = [](const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  const double low = mean_of(learnt[0]), high = mean_of(learnt[1]), middle = 0.5 * (low + high);
  double told = 0;
  for (const double value : tried[0]) told += (value < middle) == (low < high) ? 1 : 0;
  for (const double value : tried[1]) told += (value > middle) == (low < high) ? 1 : 0;
  return told / static_cast<double>(tried[0].size() + tried[1].size());
}

}  // namespace osteomill::testing_support
