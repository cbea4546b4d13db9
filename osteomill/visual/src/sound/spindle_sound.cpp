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
// A motor under full load gives way by this share.
constexpr double kLoadSlowdown = 0.08;
constexpr double kSpeedFollows_per_s = 9;
constexpr double kLoadFollows_per_s = 25;
constexpr double kIdleLoudness = 0.10;
constexpr double kLoadLoudness = 0.28;
constexpr double kNoiseLoudness = 0.22;
// Shares of the tone and its overtones, and of half the tone, because bearings are never quite round.
constexpr double kOvertones[] = {1.0, 0.45, 0.22, 0.10};
constexpr double kHalfTone = 0.12;

double sine(double turns) {
  return std::sin(2 * std::numbers::pi * turns);
}

// Pieces of 256 samples: longer ones make the sound lag and stutter.
constexpr ALCint kRefresh_hz = SoundStream::kSampleRate_hz / 256;

// The libraries below OpenAL complain on standard error of a machine without sound, which is no fault.
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

double SpindleSound::pitch_hz(const SpindleState& state) {
  return state.speed_rpm / kSecondsPerMinute * (1 - kLoadSlowdown * std::clamp(state.load, 0.0, 1.0));
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
      // An overtone above half the sample rate would come back as another tone.
      if (overtone * pitch_hz_ < 0.45 * sample_rate_hz_) tone += share * sine(overtone * turns_);
      overtone += 1;
    }
    const double hiss = kNoiseLoudness * load_ * static_cast<double>(noise());
    sample = static_cast<float>(loudness_ * ((kIdleLoudness + kLoadLoudness * load_) * tone + hiss));
  }
}

void SoundStream::fill(unsigned buffer, const SpindleState& state) {
  sound_.render(state, samples_);
  alBufferData(buffer, AL_FORMAT_MONO_FLOAT32, samples_.data(), static_cast<ALsizei>(sizeof(samples_)),
               kSampleRate_hz);
  alSourceQueueBuffers(source_, 1, &buffer);
}

SoundStream::SoundStream() {
  alGenSources(1, &source_);
  alGenBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
  for (const unsigned buffer : buffers_) fill(buffer, {});
  alSourcePlay(source_);
}

SoundStream::~SoundStream() {
  alSourceStop(source_);
  alDeleteSources(1, &source_);
  alDeleteBuffers(static_cast<ALsizei>(buffers_.size()), buffers_.data());
}

void SoundStream::feed(const SpindleState& state) {
  ALint played = 0;
  alGetSourcei(source_, AL_BUFFERS_PROCESSED, &played);
  for (; played > 0; --played) {
    ALuint buffer = 0;
    alSourceUnqueueBuffers(source_, 1, &buffer);
    fill(buffer, state);
  }
  // It stops by itself if it ran dry.
  ALint doing = AL_PLAYING;
  alGetSourcei(source_, AL_SOURCE_STATE, &doing);
  if (doing != AL_PLAYING) alSourcePlay(source_);
}

struct SoundPlayer::Impl {
  std::atomic<double> speed_rpm{0};
  std::atomic<double> load{0};
  ALCdevice* device = nullptr;
  ALCcontext* context = nullptr;
  std::jthread thread;

  void play(const std::stop_token& stop) {
    SoundStream stream;
    while (!stop.stop_requested()) {
      stream.feed({speed_rpm.load(std::memory_order_relaxed), load.load(std::memory_order_relaxed)});
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

void SoundPlayer::set(const SpindleState& state) {
  impl_->speed_rpm.store(state.speed_rpm, std::memory_order_relaxed);
  impl_->load.store(state.load, std::memory_order_relaxed);
}

}  // namespace osteomill
