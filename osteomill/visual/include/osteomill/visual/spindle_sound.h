#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "osteomill/visual/distance_beat.h"

namespace osteomill {

/// State of a spindle that determines its sound.
struct SpindleState {
  /// Actual speed; silent at 0.
  double speed_rpm = 0;
  /// Cutting power relative to that of the loudest sound, 0 to 1 (`sound_load`).
  double load = 0;
  /// Density being cut, relative to the scan's reference.
  double density = 1;
  /// A diamond burr hisses, a cutting burr sings.
  bool is_abrasive = false;
};

/// Returns the load for a cutting power; 0.5 at 4 W.
double sound_load(double cutting_power_W);

/// Synthesizes a spindle's sound: its rotation tone with overtones, louder under load, and cutting noise,
/// including a band at 4 kHz that grows with bone density. Deterministic. For one thread.
class SpindleSound {
 public:
  explicit SpindleSound(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// Computes the next samples, -1 to 1, mono. Speed and loudness follow the state within about a quarter of
  /// a second, as a motor does, without clicks.
  void render(const SpindleState& state, std::span<float> samples);

  /// Returns the settled frequency of the tone.
  static double pitch_hz(const SpindleState& state);

 private:
  float noise();
  double band(double white);

  double sample_rate_hz_;
  double pitch_hz_ = 0;
  double loudness_ = 0;
  double load_ = 0;
  double density_ = 1;
  double phase_turns_ = 0;
  std::uint32_t noise_ = 1;
  float white_noise_ = 0;
  float smooth_noise_ = 0;
  // Last two input and output samples of the band filter.
  std::array<double, 2> band_in_{}, band_out_{};
};

/// Queues the sound of a spindle, and the beat for a nearby structure, in the current OpenAL context, about
/// 70 ms ahead. For one thread.
class SoundStream {
 public:
  static constexpr int kSampleRate_hz = 44100;

  SoundStream();
  ~SoundStream();
  SoundStream(const SoundStream&) = delete;
  SoundStream& operator=(const SoundStream&) = delete;

  /// Refills the played buffers with the present sound. Call at least every 15 ms or so.
  void feed(const SpindleState& state, const BeatState& beat = {});

 private:
  static constexpr std::size_t kSamples = 768;

  void fill(unsigned buffer, const SpindleState& state, const BeatState& beat);

  SpindleSound sound_{kSampleRate_hz};
  DistanceBeat beat_{kSampleRate_hz};
  // OpenAL names.
  unsigned source_ = 0;
  std::array<unsigned, 4> buffers_{};
  std::array<float, kSamples> samples_{};
};

/// Plays a spindle's sound on the system's sound device, from a thread of its own. Without a device it does
/// nothing and reports no error.
class SoundPlayer {
 public:
  SoundPlayer();
  ~SoundPlayer();
  SoundPlayer(const SoundPlayer&) = delete;
  SoundPlayer& operator=(const SoundPlayer&) = delete;

  /// Sets the spindle's state and the beat. Call from one thread; never waits.
  void set(const SpindleState& state, const BeatState& beat = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
