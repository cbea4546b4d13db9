#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// Writes one record per tick to an HDF5 file (layout: recording_file.h) from a thread of its own.
///
/// While recording NAME.h5, the file is called NAME.part.h5; `close` renames it, so that a file with the
/// final name is always complete. The file is flushed about twice a second: a killed program leaves a
/// NAME.part.h5 that read_recording and other HDF5 programs can open (the extension stays last for them); at
/// most its last second is missing. A recorder destroyed without `close`, as during stack unwinding, leaves
/// the same, with all records. The next recording of the same name renames the leftover to NAME.part-1.h5, or
/// the first free number (`leftover_note`). If another program is still writing it, the constructor throws.
///
/// If several sessions follow each other on a bone (HapticThread::replace), announce each with
/// `begin_session`; TickRecord::session refers to its number.
///
/// One thread pushes; another (or the same) makes, closes and destroys the recorder, after the last push.
class Recorder {
 public:
  /// Queue capacity, records (16 s at 1000 Hz). If the queue is full, records are lost.
  static constexpr std::size_t kCapacity = 16384;

  /// When the first session's records are written: at once, if the session begins with the recording, or
  /// after `begin_session` has given its initial state.
  enum class FirstSession : unsigned char { begins_at_once, begins_when_announced };

  /// Fate of the file if the recorder is destroyed without `close`. A file without records is always removed;
  /// `remove` is for runs that can simply be repeated.
  enum class UnfinishedFile : unsigned char { keep, remove };

  /// Throws InputError, naming the file, if it cannot be created or another program is writing it, and
  /// std::invalid_argument if the description cannot be stored (write_description).
  Recorder(const std::filesystem::path& path, const RunDescription& description,
           FirstSession first_session = FirstSession::begins_at_once,
           UnfinishedFile unfinished = UnfinishedFile::keep);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Queues a record for the writing thread. If the queue is full, drops and counts the record and returns
  /// false. Safe in the haptic tick: never waits, allocates or throws.
  bool push(const TickRecord& record) noexcept;
  /// Like `push`, but waits while the queue is full: for runs in simulated time, not for the haptic tick. If
  /// writing has failed, throws its InputError.
  void push_waiting(const TickRecord& record);

  /// Sets the initial state of session `number`, which applies from the first record with that number;
  /// records may already have been pushed. Call in the order of the numbers. The first session uses the
  /// recording's own description.
  void begin_session(std::uint32_t number, SessionStart start);

  /// Returns a message on the unfinished recording that was found and its new name; empty if there was none.
  std::string leftover_note() const;

  /// Returns the number of lost records. Callable from any thread.
  std::uint64_t dropped() const noexcept;
  /// Returns whether writing has failed, as on a full disk; `close` throws the reason. Callable from any
  /// thread.
  bool failed() const noexcept;

  /// Adds a view to the recording. Call it from the thread that closes the recorder.
  void add_view(const ViewSample& view);

  /// Adds a picture, to be stored by `close`. `png` holds the bytes of a PNG file. Throws
  /// std::invalid_argument if the name is already used or has characters other than letters, digits, '-' and
  /// '_'.
  void add_picture(const std::string& name, std::vector<unsigned char> png);

  /// Adds a setting that is known only at the end of the run, to be stored by `close`. The description must
  /// not have its key.
  void add_setting(RunSetting setting);

  /// Writes the remaining records, the pictures and the settings, and gives the file its final name. Throws
  /// InputError if that fails or writing failed before. Call once.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a recording without ticks that holds the initial state of a session. Writes the file atomically.
/// Throws InputError if it cannot be written.
void write_start(const std::filesystem::path& path, const SessionStart& start);

/// Returns the name under which a recording is written before it is renamed to `path`.
std::filesystem::path unfinished_recording_path(const std::filesystem::path& path);

}  // namespace osteomill
