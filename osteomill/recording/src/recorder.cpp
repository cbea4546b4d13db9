#include "osteomill/recording/recorder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/signal_cleanup.h"
#include "osteomill/base/spsc_queue.h"

#include "recording_file.h"

namespace osteomill {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto kFlushEvery = 400ms;
// Chunks are written whole, unless records arrive so slowly that they would wait longer than this.
constexpr auto kMaxWait = 800ms;
// The pushing thread must not make system calls, so it does not notify the writing thread, which polls.
constexpr auto kPollInterval = 2ms;
constexpr std::size_t kRowsAtOnce = 2 * RecordingFile::kChunkRows;

// Resolves the output path. Refuses pipes and devices, because HDF5 needs random access and the file is
// renamed at the end.
fs::path resolve_output_file(const fs::path& path) {
  fs::path file = output_path(path);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(path.string(), "is not a regular file; a recording needs one");
  return file;
}

}  // namespace

struct Recorder::Impl {
  using Clock = std::chrono::steady_clock;

  Impl(const fs::path& path_, const RunDescription& description, FirstSession first_session,
       UnfinishedFile unfinished_)
      : unfinished(unfinished_),
        path(resolve_output_file(path_)),
        part(resolve_output_file(unfinished_recording_path(path))),
        kept(set_aside(part)),
        held(FileLock::create_locked(part)),
        file(part, description) {
    if (unfinished == UnfinishedFile::remove) signal_cleanup.emplace(part);
    if (first_session == FirstSession::begins_at_once) {
      file.begin_session({}, 0);
      session = 0;
    }
    rows.reserve(kRowsAtOnce);
    try {
      writer = std::jthread([this](const std::stop_token& stop) { write_until(stop); });
    } catch (const std::system_error&) {
      remove();
      throw InputError(path.string(),
                       "cannot be recorded: no thread can be started; raise the limit (ulimit -u)");
    }
  }
  ~Impl() {
    stop();
    if (unfinished == UnfinishedFile::remove || file.rows() == 0) remove();
  }

  void remove() const noexcept {
    std::error_code ignored;
    if (held && held->is_at(part)) fs::remove(part, ignored);
  }

  void stop() {
    writer.request_stop();
    if (writer.joinable()) writer.join();
  }

  void write_until(const std::stop_token& stop) noexcept {
    try {
      auto flushed = Clock::now();
      std::uint64_t flushed_rows = 0;
      for (bool all_written = false; !all_written;) {
        // Read before the queue, so that records pushed before the stop are still written.
        const bool last = stop.stop_requested();
        const bool emptied = collect_queued_records();
        all_written = last && emptied;
        const auto now = Clock::now();
        if (rows.empty()) waiting_since = now;
        write_rows(all_written || now - waiting_since >= kMaxWait);
        if (all_written || now - flushed >= kFlushEvery) write_views();
        if (all_written || (file.rows() > flushed_rows && now - flushed >= kFlushEvery)) {
          file.flush(dropped.load(std::memory_order_relaxed));
          flushed = now;
          flushed_rows = file.rows();
        }
        if (emptied && !last) std::this_thread::sleep_for(kPollInterval);
      }
    } catch (...) {
      failure = std::current_exception();
      failed.store(true, std::memory_order_release);
    }
  }

  // Takes a bounded number of records, so that a fast producer cannot delay the flush. Returns false if more
  // are queued.
  bool collect_queued_records() {
    while (rows.size() < kRowsAtOnce) {
      const TickRecord* record = queue.front();
      if (record == nullptr) return true;
      if (session != record->session && !begin_session_of(*record)) return true;
      rows.push_back(*record);
      queue.pop();
    }
    return false;
  }

  void write_views() {
    std::vector<ViewSample> waiting;
    {
      const std::lock_guard lock(starts_mutex);
      waiting.swap(views);
    }
    file.append_views(waiting);
  }

  // Starts the session of a record; returns false if its initial state is not known yet.
  bool begin_session_of(const TickRecord& record) {
    const std::lock_guard lock(starts_mutex);
    for (; !starts.empty() && starts.front().first <= record.session; starts.pop_front()) {
      file.begin_session(starts.front().second, file.rows() + rows.size());
      session = starts.front().first;
    }
    return session == record.session;
  }

  // Writes rows up to the end of a chunk, or all.
  void write_rows(bool all) {
    const std::size_t room = RecordingFile::kChunkRows - file.rows() % RecordingFile::kChunkRows;
    std::size_t count = rows.size();
    if (!all) count = count < room ? 0 : count - (count - room) % RecordingFile::kChunkRows;
    if (count == 0) return;
    file.append({rows.data(), count});
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
    waiting_since = Clock::now();
  }

  UnfinishedFile unfinished;
  fs::path path;
  fs::path part;
  std::optional<fs::path> kept;
  // Held until the file has its final name.
  std::optional<FileLock> held;
  RecordingFile file;
  std::optional<SignalCleanup> signal_cleanup;
  SpscQueue<TickRecord> queue{kCapacity};
  // Used by the writing thread only: records taken from the queue but not yet written, and the current
  // session.
  std::vector<TickRecord> rows;
  Clock::time_point waiting_since;
  std::optional<std::uint32_t> session;
  std::mutex starts_mutex;
  std::deque<std::pair<std::uint32_t, SessionStart>> starts;
  std::vector<ViewSample> views;
  std::vector<RunPicture> pictures;
  std::vector<RunSetting> settings;
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<bool> failed{false};
  // Written before `failed` is set and read after.
  std::exception_ptr failure;
  bool closed = false;
  std::jthread writer;
};

Recorder::Recorder(const fs::path& path, const RunDescription& description, FirstSession first_session,
                   UnfinishedFile unfinished)
    : impl_(std::make_unique<Impl>(path, description, first_session, unfinished)) {}

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

void Recorder::begin_session(std::uint32_t number, SessionStart start) {
  const std::lock_guard lock(impl_->starts_mutex);
  impl_->starts.emplace_back(number, std::move(start));
}

std::string Recorder::leftover_note() const {
  if (!impl_->kept) return {};
  return impl_->part.string() + ": an unfinished recording, kept as " + impl_->kept->string();
}

std::uint64_t Recorder::dropped() const noexcept {
  return impl_->dropped.load(std::memory_order_relaxed);
}

bool Recorder::failed() const noexcept {
  return impl_->failed.load(std::memory_order_acquire);
}

void Recorder::add_view(const ViewSample& view) {
  const std::lock_guard lock(impl_->starts_mutex);
  impl_->views.push_back(view);
}

void Recorder::add_picture(const std::string& name, std::vector<unsigned char> png) {
  const auto same = [&](const RunPicture& picture) { return picture.name == name; };
  if (name.empty() || !is_plain_name(name) ||
      std::any_of(impl_->pictures.begin(), impl_->pictures.end(), same)) {
    throw std::invalid_argument("'" + name + "' is not a valid name of a picture, or is already used");
  }
  impl_->pictures.push_back({name, std::move(png)});
}

void Recorder::add_setting(RunSetting setting) {
  impl_->settings.push_back(std::move(setting));
}

void Recorder::close() {
  if (impl_->closed) throw std::logic_error("Recorder: close() was called twice");
  impl_->closed = true;
  impl_->stop();
  if (failed()) std::rethrow_exception(impl_->failure);
  for (const RunPicture& picture : impl_->pictures) impl_->file.add_picture(picture.name, picture.png);
  for (const RunSetting& setting : impl_->settings) impl_->file.add_setting(setting);
  impl_->file.finish(dropped());
  if (!impl_->held->is_at(impl_->part))
    throw InputError(impl_->part.string(), "was renamed or removed while it was written");
  std::error_code error;
  fs::rename(impl_->part, impl_->path, error);
  if (error) throw InputError(impl_->path.string(), "cannot be written: " + error.message());
  impl_->held.reset();
}

void write_start(const fs::path& path, const SessionStart& start) {
  write_file_atomically(path, [&](const fs::path& beside) {
    RecordingFile file(beside, start.run);
    file.begin_session(start, 0);
    file.finish(0);
  });
}

fs::path unfinished_recording_path(const fs::path& path) {
  return path.parent_path() / (path.stem().string() + ".part" + path.extension().string());
}

}  // namespace osteomill
