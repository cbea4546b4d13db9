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

/// Writes one record a tick to an HDF5 file (the layout: recording_file.h) from a thread of its own.
///
/// While it runs the file is called NAME.part.h5 if NAME.h5 was asked for; `close` gives it its name, so a
/// file of the final name is always whole. Twice a second what was recorded so far is made safe: a program
/// that is killed leaves a NAME.part.h5 that read_recording opens, less the last second at the most, and that
/// other HDF5 programs open too (hence the extension stays last). A recorder destroyed without `close`, as
/// when an exception passes, leaves the same, with nothing missing. The next recording of that name renames
/// it to NAME.part-1.h5, or the first number that is free (`leftover_note`); one that is still being written
/// by another program is left alone, and the recorder cannot be made.
///
/// If several sessions follow each other on a bone (HapticThread::replace), `begin_session` is told of each;
/// the number in a record names its session.
///
/// One thread pushes; another (or the same) makes, closes and destroys the recorder, after the last push.
class Recorder {
 public:
  /// Number of records (16 s at 1000 Hz) that can wait to be written before any is lost.
  static constexpr std::size_t kCapacity = 16384;

  /// The time from which the first session's records are written: at once, for a session that begins with the
  /// recording, or from when `begin_session` says what it began from.
  enum class FirstSession : unsigned char { begins_at_once, begins_when_announced };

  /// The fate of the file if the recorder is destroyed without `close`. It is removed in any case if nothing
  /// was recorded yet; `remove` is for runs that can simply be run again.
  enum class UnfinishedFile : unsigned char { keep, remove };

  /// Throws InputError, naming the file, if it cannot be created or another program writes it, and
  /// std::invalid_argument if the description cannot be stored (write_description).
  Recorder(const std::filesystem::path& path, const RunDescription& description,
           FirstSession first_session = FirstSession::begins_at_once,
           UnfinishedFile unfinished = UnfinishedFile::keep);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Hands a record to the writing thread. Safe in the haptic tick: never waits, allocates or throws. If the
  /// queue is full the record is lost and counted, and false is returned.
  bool push(const TickRecord& record) noexcept;
  /// Takes a record of a run in simulated time, outside the tick: waits while the queue is full. Throws the
  /// InputError with which writing failed, if it did.
  void push_waiting(const TickRecord& record);

  /// Says what the session of this number began from, which belongs to the first record of that number; that
  /// may have been pushed before. To be called in the order of the numbers. The first session's description
  /// is the recording's own.
  void begin_session(std::uint32_t number, SessionStart start);

  /// Returns a line on the unfinished recording that was there and where it is kept; empty if there was none.
  std::string leftover_note() const;

  /// Returns how many records were lost. From any thread.
  std::uint64_t dropped() const noexcept;
  /// Returns whether writing has failed (a full disk); the reason comes from `close`. From any thread.
  bool failed() const noexcept;

  /// Adds a view to those of the recording. Call it from the thread that closes the recorder.
  void add_view(const ViewSample& view);

  /// Adds a picture to be stored at closing. `png` are the bytes of a PNG file; the name must be new and hold
  /// only letters, digits, '-' and '_' (else std::invalid_argument).
  void add_picture(const std::string& name, std::vector<unsigned char> png);

  /// Adds a setting of the run that is known only at its end, under a key that the description does not have;
  /// it is stored at closing.
  void add_setting(RunSetting setting);

  /// Writes what is left, the pictures and settings, and gives the file its name. Throws InputError if any of
  /// it fails, or writing failed before. To be called once.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a recording of no ticks: what a session may go on from. The file appears whole or not at all.
/// Throws InputError if it cannot be written.
void write_start(const std::filesystem::path& path, const SessionStart& start);

/// Returns the name under which a recording that is to become `path` is written.
std::filesystem::path unfinished_recording_path(const std::filesystem::path& path);

}  // namespace osteomill
