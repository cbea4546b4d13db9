#include "osteomill/recording/recorder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <thread>

#include "osteomill/device/spsc_queue.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/recording_file.h"

namespace osteomill {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto kFlushEvery = 100ms;
// The pushing thread wakes nobody (that would be a system call), so the writing thread looks by itself.
constexpr auto kLookEvery = 2ms;
constexpr std::size_t kRowsAtOnce = 1024;

bool is_plain_name(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), plain);
}

// HDF5 writes here and there in a file, which then takes the place of what was there.
fs::path file_behind(const fs::path& path) {
  const fs::path file = behind_links(path);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(path.string(), "is no regular file, which a recording has to be");
  return file;
}

}  // namespace

struct Recorder::Impl {
  Impl(const fs::path& path_, const RunDescription& description, std::size_t capacity)
      : path(file_behind(path_)), file(unfinished_recording_path(path), description), queue(capacity) {
    rows.reserve(kRowsAtOnce);
    writer = std::thread([this] { write_until_stopped(); });
  }
  ~Impl() { stop(); }

  void stop() {
    stopping.store(true, std::memory_order_release);
    if (writer.joinable()) writer.join();
  }

  void write_until_stopped() noexcept {
    try {
      auto flushed = std::chrono::steady_clock::now();
      for (bool all_written = false; !all_written;) {
        // Read before the queue: what was pushed before the stop is then still written.
        const bool last = stopping.load(std::memory_order_acquire);
        const bool emptied = write_some();
        all_written = last && emptied;
        if (const auto now = std::chrono::steady_clock::now(); all_written || now - flushed >= kFlushEvery) {
          file.flush(dropped.load(std::memory_order_relaxed));
          flushed = now;
        }
        if (emptied && !last) std::this_thread::sleep_for(kLookEvery);
      }
    } catch (...) {
      failure = std::current_exception();
      failed.store(true, std::memory_order_release);
    }
  }

  // A bounded part of the queue, so that records which come as fast as they are written cannot put off the
  // flush.
  bool write_some() {
    rows.clear();
    TickRecord record;
    while (rows.size() < kRowsAtOnce && queue.try_pop(record)) rows.push_back(record);
    file.append(rows);
    return rows.size() < kRowsAtOnce;
  }

  fs::path path;
  RecordingFile file;
  SpscQueue<TickRecord> queue;
  std::vector<TickRecord> rows;
  std::vector<RunPicture> pictures;
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<bool> stopping{false};
  std::atomic<bool> failed{false};
  // Written before `failed` is set and read after.
  std::exception_ptr failure;
  bool closed = false;
  std::thread writer;
};

Recorder::Recorder(const fs::path& path, const RunDescription& description, std::size_t capacity)
    : impl_(std::make_unique<Impl>(path, description, capacity)) {}

Recorder::~Recorder() = default;

bool Recorder::push(const TickRecord& record) noexcept {
  if (impl_->queue.try_push(record)) return true;
  impl_->dropped.fetch_add(1, std::memory_order_relaxed);
  return false;
}

void Recorder::push_waiting(const TickRecord& record) {
  while (!impl_->queue.try_push(record)) {
    if (failed()) std::rethrow_exception(impl_->failure);
    std::this_thread::sleep_for(200us);
  }
}

std::uint64_t Recorder::dropped() const noexcept {
  return impl_->dropped.load(std::memory_order_relaxed);
}

bool Recorder::failed() const noexcept {
  return impl_->failed.load(std::memory_order_acquire);
}

void Recorder::add_picture(const std::string& name, std::vector<unsigned char> png) {
  const auto same = [&](const RunPicture& picture) { return picture.name == name; };
  if (!is_plain_name(name) || std::any_of(impl_->pictures.begin(), impl_->pictures.end(), same)) {
    throw std::invalid_argument("'" + name + "' cannot be the name of a picture, or is one already");
  }
  impl_->pictures.push_back({name, std::move(png)});
}

void Recorder::close() {
  if (impl_->closed) throw std::logic_error("a recorder is closed once");
  impl_->closed = true;
  impl_->stop();
  if (failed()) std::rethrow_exception(impl_->failure);
  for (const RunPicture& picture : impl_->pictures) impl_->file.add_picture(picture.name, picture.png);
  impl_->file.finish(dropped());
  std::error_code error;
  fs::rename(unfinished_recording_path(impl_->path), impl_->path, error);
  if (error) throw InputError(impl_->path.string(), "cannot be written: " + error.message());
}

fs::path unfinished_recording_path(const fs::path& path) {
  return path.parent_path() / (path.stem().string() + ".part" + path.extension().string());
}

}  // namespace osteomill
