#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace osteomill {

/// The state of a spindle, from which its sound follows.
struct SpindleState {
  /// The speed that it is set to; 0 is off.
  double speed_rpm = 0;
  /// The load of cutting, 0 to 1.
  double load = 0;
};

/// Computes the sound of a spindle: the tone of its turning with its overtones, a little lower and a good
/// deal louder under load, and the noise of cutting. The same states give the same samples. For one thread.
class SpindleSound {
 public:
  explicit SpindleSound(double sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {}

  /// Computes the next samples, -1 to 1, one channel. Speed and loudness follow the state within a quarter of
  /// a second or so, as a motor does, without a click.
  void render(const SpindleState& state, std::span<float> samples);

  /// Returns the tone's frequency for a speed and a load when it has settled.
  static double pitch_hz(const SpindleState& state);

 private:
  float noise();

  double sample_rate_hz_;
  double pitch_hz_ = 0;
  double loudness_ = 0;
  double load_ = 0;
  double turns_ = 0;
  std::uint32_t noise_ = 1;
  float smooth_noise_ = 0;
};

/// Queues a spindle's sound to the OpenAL context that is current, some 70 ms ahead. For one thread.
class SoundStream {
 public:
  static constexpr int kSampleRate_hz = 44100;

  SoundStream();
  ~SoundStream();
  SoundStream(const SoundStream&) = delete;
  SoundStream& operator=(const SoundStream&) = delete;

  /// Fills the played buffers with the spindle's present sound. Call at least every 15 ms or so.
  void feed(const SpindleState& state);

 private:
  static constexpr std::size_t kSamples = 768;

  void fill(unsigned buffer, const SpindleState& state);

  SpindleSound sound_{kSampleRate_hz};
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

  /// Sets the spindle's state. Call from one thread; never waits.
  void set(const SpindleState& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
