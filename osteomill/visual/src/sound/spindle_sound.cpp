#include "osteomill/visual/spindle_sound.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stop_token>
#include <thread>

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <fcntl.h>
#include <unistd.h>

namespace osteomill {

namespace {

using namespace std::chrono_literals;

constexpr double kSecondsPerMinute = 60;
constexpr double kSpeedFollows_per_s = 9;
constexpr double kLoadFollows_per_s = 25;
constexpr double kIdleLoudness = 0.10;
constexpr double kLoadLoudness = 0.28;
constexpr double kNoiseLoudness = 0.15;
constexpr double kBandLoudness = 0.14;
// Higher densities sound the same.
constexpr double kMaxDensity = 3;
// Factors for a diamond burr relative to a cutting burr: overtones, and noise.
constexpr double kAbrasiveTones = 0.4;
constexpr double kAbrasiveNoise = 1.5;
// Amplitudes of the tone and its overtones, and of a subharmonic at half its frequency (bearings are never
// quite round).
constexpr double kOvertones[] = {1.0, 0.45, 0.22, 0.10};
constexpr double kHalfTone = 0.12;

double sine(double turns) {
  return std::sin(2 * std::numbers::pi * turns);
}

// OpenAL period of 256 samples: with longer ones the sound lags and stutters.
constexpr ALCint kRefresh_hz = SoundStream::kSampleRate_hz / 256;

// Libraries below OpenAL print errors on a machine without sound, which is not a fault.
class QuietStderr {
 public:
  QuietStderr() : kept_(dup(STDERR_FILENO)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) close(nowhere);
  }
  ~QuietStderr() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int kept_;
};

}  // namespace

double sound_load(double cutting_power_W) {
  constexpr double kHalf_W = 4;
  return cutting_power_W > 0 ? cutting_power_W / (cutting_power_W + kHalf_W) : 0;
}

double SpindleSound::pitch_hz(const SpindleState& state) {
  return state.speed_rpm / kSecondsPerMinute;
}

// Band-pass filter with constant peak gain (Audio EQ Cookbook).
double SpindleSound::band(double white) {
  constexpr double kCentre_hz = 4000, kQuality = 2;
  const double angle = 2 * std::numbers::pi * kCentre_hz / sample_rate_hz_;
  const double alpha = std::sin(angle) / (2 * kQuality);
  const double out =
      (alpha * (white - band_in_[1]) + 2 * std::cos(angle) * band_out_[0] - (1 - alpha) * band_out_[1]) /
      (1 + alpha);
  band_in_ = {white, band_in_[0]};
  band_out_ = {out, band_out_[0]};
  return out;
}

float SpindleSound::noise() {
  noise_ = 1664525u * noise_ + 1013904223u;
  white_noise_ = static_cast<float>(noise_ >> 8) / 8388608.0f - 1.0f;
  smooth_noise_ += 0.35f * (white_noise_ - smooth_noise_);
  return smooth_noise_;
}

void SpindleSound::render(const SpindleState& state, std::span<float> samples) {
  const bool on = state.speed_rpm > 0;
  const double speed_share = 1 - std::exp(-kSpeedFollows_per_s / sample_rate_hz_);
  const double load_share = 1 - std::exp(-kLoadFollows_per_s / sample_rate_hz_);
  const double wanted_load = on ? std::clamp(state.load, 0.0, 1.0) : 0;
  const double wanted_density = std::clamp(state.density, 0.0, kMaxDensity);
  const double tones = state.is_abrasive ? kAbrasiveTones : 1;
  const double noises = state.is_abrasive ? kAbrasiveNoise : 1;
  for (float& sample : samples) {
    pitch_hz_ += speed_share * (pitch_hz(state) - pitch_hz_);
    loudness_ += speed_share * ((on ? 1.0 : 0.0) - loudness_);
    load_ += load_share * (wanted_load - load_);
    density_ += load_share * (wanted_density - density_);
    phase_turns_ += pitch_hz_ / sample_rate_hz_;
    phase_turns_ -= 2 * std::floor(0.5 * phase_turns_);
    double tone = kHalfTone * sine(0.5 * phase_turns_);
    double overtone = 1;
    for (const double share : kOvertones) {
      // Skip overtones near half the sample rate and above, which would alias.
      if (overtone * pitch_hz_ < 0.45 * sample_rate_hz_)
        tone += (overtone > 1 ? tones : 1) * share * sine(overtone * phase_turns_);
      overtone += 1;
    }
    const double hiss = kNoiseLoudness * static_cast<double>(noise());
    const double ring = kBandLoudness * density_ * band(static_cast<double>(white_noise_));
    sample = static_cast<float>(
        loudness_ * ((kIdleLoudness + kLoadLoudness * load_) * tone + noises * load_ * (hiss + ring)));
  }
}

void SoundStream::fill(unsigned buffer, const SpindleState& state, const BeatState& beat) {
  sound_.render(state, samples_);
  beat_.add_to(beat, samples_);
  alBufferData(buffer, AL_FORMAT_MONO_FLOAT32, samples_.data(), static_cast<ALsizei>(sizeof(samples_)),
               kSampleRate_hz);
  alSourceQueueBuffers(source_, 1, &buffer);
}

SoundStream::SoundStream() {
  alGenSources(1, &source_);
  alGenBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
  for (const unsigned buffer : buffers_) fill(buffer, {}, {});
  alSourcePlay(source_);
}

SoundStream::~SoundStream() {
  alSourceStop(source_);
  alDeleteSources(1, &source_);
  alDeleteBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
}

void SoundStream::feed(const SpindleState& state, const BeatState& beat) {
  ALint played = 0;
  alGetSourcei(source_, AL_BUFFERS_PROCESSED, &played);
  for (; played > 0; --played) {
    ALuint buffer = 0;
    alSourceUnqueueBuffers(source_, 1, &buffer);
    fill(buffer, state, beat);
  }
  // OpenAL stops a source that has run out of buffers.
  ALint doing = AL_PLAYING;
  alGetSourcei(source_, AL_SOURCE_STATE, &doing);
  if (doing != AL_PLAYING) alSourcePlay(source_);
}

struct SoundPlayer::Impl {
  std::atomic<double> speed_rpm{0};
  std::atomic<double> load{0};
  std::atomic<double> density{1};
  std::atomic<bool> is_abrasive{false};
  std::atomic<double> beats_per_s{0};
  std::atomic<double> beat_hz{0};
  ALCdevice* device = nullptr;
  ALCcontext* context = nullptr;
  std::jthread thread;

  void play(const std::stop_token& stop) {
    SoundStream stream;
    while (!stop.stop_requested()) {
      constexpr auto kRelaxed = std::memory_order_relaxed;
      stream.feed(
          {speed_rpm.load(kRelaxed), load.load(kRelaxed), density.load(kRelaxed), is_abrasive.load(kRelaxed)},
          {beats_per_s.load(kRelaxed), beat_hz.load(kRelaxed)});
      std::this_thread::sleep_for(8ms);
    }
  }
};

SoundPlayer::SoundPlayer() : impl_(std::make_unique<Impl>()) {
  const QuietStderr quiet;
  impl_->device = alcOpenDevice(nullptr);
  if (impl_->device == nullptr) return;
  const ALCint wanted[] = {ALC_FREQUENCY, SoundStream::kSampleRate_hz, ALC_REFRESH, kRefresh_hz, 0};
  impl_->context = alcCreateContext(impl_->device, wanted);
  if (impl_->context == nullptr || alcMakeContextCurrent(impl_->context) == ALC_FALSE) return;
  impl_->thread = std::jthread([this](const std::stop_token& stop) { impl_->play(stop); });
}

SoundPlayer::~SoundPlayer() {
  impl_->thread.request_stop();
  if (impl_->thread.joinable()) impl_->thread.join();
  alcMakeContextCurrent(nullptr);
  if (impl_->context != nullptr) alcDestroyContext(impl_->context);
  if (impl_->device != nullptr) alcCloseDevice(impl_->device);
}

void SoundPlayer::set(const SpindleState& state, const BeatState& beat) {
  impl_->speed_rpm.store(state.speed_rpm, std::memory_order_relaxed);
  impl_->load.store(state.load, std::memory_order_relaxed);
  impl_->density.store(state.density, std::memory_order_relaxed);
  impl_->is_abrasive.store(state.is_abrasive, std::memory_order_relaxed);
  impl_->beats_per_s.store(beat.beats_per_s, std::memory_order_relaxed);
  impl_->beat_hz.store(beat.pitch_hz, std::memory_order_relaxed);
}

}  // namespace osteomill
