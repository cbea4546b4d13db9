#include "osteomill/sound/sound_stream.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <thread>

#include <AL/al.h>
#include <AL/alc.h>
#include <fcntl.h>
#include <unistd.h>

namespace osteomill {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSamples = 768;
constexpr std::size_t kBuffers = 4;
// Pieces of 256 samples: longer ones make the sound lag and stutter.
constexpr ALCint kRefresh_hz = SoundStream::kSampleRate_hz / 256;

// The libraries below OpenAL complain on standard error of a machine without sound, where nothing is wrong.
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

struct SoundStream::Impl {
  SpindleSound sound{kSampleRate_hz};
  ALuint source = 0;
  std::array<ALuint, kBuffers> buffers{};
  std::array<float, kSamples> samples{};
  std::array<std::int16_t, kSamples> words{};

  void fill(ALuint buffer, const SpindleState& state) {
    sound.render(state, samples);
    for (std::size_t n = 0; n < kSamples; ++n) {
      words[n] = static_cast<std::int16_t>(std::lround(32000 * samples[n]));
    }
    alBufferData(buffer, AL_FORMAT_MONO16, words.data(), static_cast<ALsizei>(sizeof(words)), kSampleRate_hz);
    alSourceQueueBuffers(source, 1, &buffer);
  }
};

SoundStream::SoundStream() : impl_(std::make_unique<Impl>()) {
  alGenSources(1, &impl_->source);
  alGenBuffers(kBuffers, impl_->buffers.data());
  for (const ALuint buffer : impl_->buffers) impl_->fill(buffer, {});
  alSourcePlay(impl_->source);
}

SoundStream::~SoundStream() {
  alSourceStop(impl_->source);
  alDeleteSources(1, &impl_->source);
  alDeleteBuffers(kBuffers, impl_->buffers.data());
}

void SoundStream::feed(const SpindleState& state) {
  ALint played = 0;
  alGetSourcei(impl_->source, AL_BUFFERS_PROCESSED, &played);
  for (; played > 0; --played) {
    ALuint buffer = 0;
    alSourceUnqueueBuffers(impl_->source, 1, &buffer);
    impl_->fill(buffer, state);
  }
  // It stops by itself where it ran dry.
  ALint doing = AL_PLAYING;
  alGetSourcei(impl_->source, AL_SOURCE_STATE, &doing);
  if (doing != AL_PLAYING) alSourcePlay(impl_->source);
}

struct SoundPlayer::Impl {
  std::atomic<double> speed_rpm{0};
  std::atomic<double> load{0};
  std::atomic<bool> stopping{false};
  ALCdevice* device = nullptr;
  ALCcontext* context = nullptr;
  std::thread thread;

  void play() {
    SoundStream stream;
    while (!stopping.load()) {
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
  impl_->thread = std::thread([this] { impl_->play(); });
}

SoundPlayer::~SoundPlayer() {
  impl_->stopping = true;
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
