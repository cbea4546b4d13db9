#pragma once

#include <memory>

#include "osteomill/sound/spindle_sound.h"

namespace osteomill {

/// Queues a spindle's sound to the OpenAL context that is current, some 70 ms ahead. For one thread.
class SoundStream {
 public:
  static constexpr int kSampleRate_hz = 44100;

  SoundStream();
  ~SoundStream();
  SoundStream(const SoundStream&) = delete;
  SoundStream& operator=(const SoundStream&) = delete;

  /// To be called at least every 15 ms or so: fills what has been played with what the spindle does now.
  void feed(const SpindleState& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Plays a spindle's sound on the system's sound device from a thread of its own. Without a device nothing is
/// heard, and nothing is wrong.
class SoundPlayer {
 public:
  SoundPlayer();
  ~SoundPlayer();
  SoundPlayer(const SoundPlayer&) = delete;
  SoundPlayer& operator=(const SoundPlayer&) = delete;

  /// From one thread; never waits.
  void set(const SpindleState& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
