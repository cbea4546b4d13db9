#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "osteomill/visual/distance_beat.h"

namespace osteomill {

/// The state of a spindle, from which its sound follows.
struct SpindleState {
  /// The true speed; 0 is silent.
  double speed_rpm = 0;
  /// The power of cutting as a share of what makes the loudest sound, 0 to 1 (`sound_load`).
  double load = 0;
  /// The density of what is cut, relative to the scan's reference.
  double density = 1;
  /// A diamond hisses, a cutting burr sings.
  bool is_abrasive = false;
};

/// Returns the load of a power of cutting: half of the loudest at 4 W.
double sound_load(double cutting_power_W);

/// Computes the sound of a spindle: the tone of its turning with its overtones, louder under load, and the
/// noise of cutting, of which a band at 4 kHz grows with the bone's density. The same states give the same
/// samples. For one thread.
class SpindleSound {
 public:
  explicit SpindleSound(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// Computes the next samples, -1 to 1, one channel. Speed and loudness follow the state within a quarter of
  /// a second or so, as a motor does, without a click.
  void render(const SpindleState& state, std::span<float> samples);

  /// Returns the tone's frequency for a speed when it has settled.
  static double pitch_hz(const SpindleState& state);

 private:
  float noise();
  double band(double white);

  double sample_rate_hz_;
  double pitch_hz_ = 0;
  double loudness_ = 0;
  double load_ = 0;
  double density_ = 1;
  double turns_ = 0;
  std::uint32_t noise_ = 1;
  float white_noise_ = 0;
  float smooth_noise_ = 0;
  // The last two samples that went into the band's filter, and came out.
  std::array<double, 2> band_in_{}, band_out_{};
};

/// Queues a spindle's sound, and the beat of a structure that is near, to the OpenAL context that is current,
/// some 70 ms ahead. For one thread.
class SoundStream {
 public:
  static constexpr int kSampleRate_hz = 44100;

  SoundStream();
  ~SoundStream();
  SoundStream(const SoundStream&) = delete;
  SoundStream& operator=(const SoundStream&) = delete;

  /// Fills the played buffers with the spindle's present sound. Call at least every 15 ms or so.
  void feed(const SpindleState& state, const BeatState& beat = {});

 private:
  static constexpr std::size_t kSamples = 768;

  void fill(unsigned buffer, const SpindleState& state, const BeatState& beat);

  SpindleSound sound_{kSampleRate_hz};
  DistanceBeat beat_{kSampleRate_hz};
  // OpenAL's names.
  unsigned source_ = 0;
  std::array<unsigned, 4> buffers_{};
  std::array<float, kSamples> samples_{};
};

/// Plays a spindle's sound on the system's sound device from a thread of its own. Without a device nothing is
/// heard, and nothing is wrong.
class SoundPlayer {
 public:
  SoundPlayer();
  ~SoundPlayer();
  SoundPlayer(const SoundPlayer&) = delete;
  SoundPlayer& operator=(const SoundPlayer&) = delete;

  /// Sets the spindle's state, and the beat. Call from one thread; never waits.
  void set(const SpindleState& state, const BeatState& beat = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
