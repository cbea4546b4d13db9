#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/recording.h"

namespace osteomill {

/// Version of the layout, in the root's attribute `osteomill_recording_version`, and the previous one, which
/// can still be read; that also has the attribute `mode`, which is ignored.
inline constexpr std::uint64_t kRecordingVersion = 6;
inline constexpr std::uint64_t kPreviousRecordingVersion = 5;

/// Recording being written (format: docs/recordings.md). One thread at a time. Every failure throws an
/// InputError that names `path`; the file then keeps what was written before. Disk space is reserved before
/// each write, so that a full disk ends a recording but does not corrupt it.
class RecordingFile {
 public:
  /// Columns are compressed in chunks of this many rows. It is cheapest to write each chunk once, as a whole.
  static constexpr std::size_t kChunkRows = 512;
  /// The bone's hash is stored once per this many rows.
  static constexpr std::uint64_t kHashRows = 100;

  /// Creates the file, overwriting an existing one.
  RecordingFile(const std::filesystem::path& path, const RunDescription& description);
  /// Closes the file. It is readable, but marked complete only if `finish` was called.
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  /// Starts a new session at `row`. The first session uses the recording's own description.
  void begin_session(const SessionStart& start, std::uint64_t row);
  void append(std::span<const TickRecord> records);
  /// Appends views to the group /view, which is created for the first one.
  void append_views(std::span<const ViewSample> views);
  std::uint64_t rows() const { return rows_; }
  /// Writes everything appended so far to the file, so that it survives a crash of this program.
  void flush(std::uint64_t dropped);
  void add_picture(const std::string& name, std::span<const unsigned char> png);
  void add_setting(const RunSetting& setting);
  /// Marks the recording complete, closes the file and writes its checksum.
  void finish(std::uint64_t dropped);

 private:
  /// Dataset of `width` numbers per row and its current number of rows.
  struct Column {
    Hdf5Handle dataset;
    hsize_t width = 1;
    hsize_t rows = 0;
  };

  void lay_out(const RunDescription& description);
  void create_columns();
  bool close();
  int descriptor() const;
  /// Returns the size of the file, bytes, including data not yet written to disk.
  std::uint64_t end() const;
  /// Reserves disk space for `bytes` beyond the current end of the file.
  void reserve(std::uint64_t bytes);
  void evict_flushed_metadata();
  Hdf5Handle create_group(hid_t in, const std::string& name) const;
  Column create_column(hid_t group, const char* name, hid_t type, const char* unit, hsize_t width,
                       hsize_t chunk_rows) const;
  void append_cuts(std::span<const TickRecord> records);
  void append_hashes(std::span<const TickRecord> records);
  void append_hash(const BoneHash& hash);
  template <typename Struct>
  std::vector<Column> create_columns_of(hid_t group, hsize_t chunk_rows) const;
  template <typename Struct>
  void append_fields(std::vector<Column>& columns, std::span<const Struct> rows);
  template <typename Value>
  void append_to(Column& column, std::span<const Value> values) const;
  void write_bricks(hid_t session, std::span<const DensityBlock> bricks) const;
  void require(bool ok, const char* what) const;

  std::filesystem::path path_;
  Hdf5Handle file_;
  std::vector<Column> columns_;
  // Columns of cuts by label: row, label, removed_mm3; empty if the bone has no labels.
  std::vector<Column> cut_columns_;
  std::vector<Column> hash_columns_;
  // Empty before the first view.
  std::vector<Column> view_columns_;
  std::vector<Label> labels_;
  std::vector<double> values_;
  std::uint64_t rows_ = 0;
  std::uint64_t sessions_ = 0;
  BoneHash last_;
  std::uint64_t flushes_ = 0;
  // Disk space reserved for the file, bytes.
  std::uint64_t reserved_ = 0;
};

/// Size of HDF5's "user block" at the start of a recording, which holds one line of text with the checksum
/// (CRC-32) of everything after it. HDF5 crashes on some damaged files, so damage must be detected before
/// HDF5 opens the file.
inline constexpr std::size_t kUserBlockBytes = 512;

/// Writes the checksum line into a finished and closed recording. Throws InputError if that fails.
void write_checksum(const std::filesystem::path& path);

/// Result of check_checksum. `none`: unfinished, or rewritten by another program. `our_own`: intact and
/// written by this process.
enum class Checksum : unsigned char { none, intact, broken, our_own };

/// Verifies the checksum. Throws InputError if the file cannot be read.
Checksum check_checksum(const std::filesystem::path& path);

/// Writes the description as attributes of the file's root, and its further settings as attributes of the
/// group /settings, with the unit of KEY in the attribute KEY.unit. Each label becomes three attributes of
/// the group /labels: VALUE.name, VALUE.colour ("#rrggbb") and VALUE.no_go (0 or 1). Throws InputError,
/// naming the file, on failure, and std::invalid_argument for a key that is empty, duplicate or ends in
/// ".unit" and for an unusable name of algorithm or phase. Call under Hdf5Lock.
void write_description(const std::filesystem::path& path, hid_t file, const RunDescription& description);
/// Adds a setting under a new key.
void add_setting(const std::filesystem::path& path, hid_t file, const RunSetting& setting);
RunDescription read_description(const std::filesystem::path& path, hid_t file);

}  // namespace osteomill
