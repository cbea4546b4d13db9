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

/// The version of the layout, in the root's attribute `osteomill_recording_version`, and the one before,
/// which is read too: it also has the attribute `mode`, of which nothing is left.
inline constexpr std::uint64_t kRecordingVersion = 6;
inline constexpr std::uint64_t kPreviousRecordingVersion = 5;

/// A recording being written, from one thread at a time; docs/recordings.md describes it. Every failure is an
/// InputError that names `path`; after one the file is closed with what it holds. Room on the disk is taken
/// before anything is written: a full disk ends a recording and spoils nothing of it.
class RecordingFile {
 public:
  /// Columns are compressed in pieces of this number of rows. A piece that is written once and whole costs
  /// least.
  static constexpr std::size_t kChunkRows = 512;
  /// One row in this number has the bone's hash.
  static constexpr std::uint64_t kHashRows = 100;

  /// Creates the file, over one that is there.
  RecordingFile(const std::filesystem::path& path, const RunDescription& description);
  /// Closes the file as it is: readable, and not marked complete unless `finish` came first.
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  /// The rows from `row` on are of another session; the first one's description is the recording's own.
  void begin_session(const SessionStart& start, std::uint64_t row);
  void append(std::span<const TickRecord> records);
  /// Adds views to the group /view, which is made for the first.
  void append_views(std::span<const ViewSample> views);
  std::uint64_t rows() const { return rows_; }
  /// Makes what was appended so far survive the end of this program, however it ends.
  void flush(std::uint64_t dropped);
  void add_picture(const std::string& name, std::span<const unsigned char> png);
  void add_setting(const RunSetting& setting);
  /// Marks the recording complete, closes the file and writes its checksum.
  void finish(std::uint64_t dropped);

 private:
  /// A dataset of `width` numbers a row, and how many rows it has.
  struct Column {
    Hdf5Handle dataset;
    hsize_t width = 1;
    hsize_t rows = 0;
  };

  void lay_out(const RunDescription& description);
  void create_columns();
  bool close();
  int descriptor() const;
  /// Returns the end of the file, in bytes, with what has not reached the disk yet.
  std::uint64_t end() const;
  /// Room on the disk for so much more than there is.
  void reserve(std::uint64_t bytes);
  void forget_flushed_metadata();
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
  // The columns of cuts by label: row, label, removed_mm3; empty if the bone has none.
  std::vector<Column> cut_columns_;
  std::vector<Column> hash_columns_;
  // None before the first view.
  std::vector<Column> view_columns_;
  std::vector<Label> labels_;
  std::vector<double> values_;
  std::uint64_t rows_ = 0;
  std::uint64_t sessions_ = 0;
  BoneHash last_;
  std::uint64_t flushes_ = 0;
  // The number of bytes of the file that have room on the disk.
  std::uint64_t reserved_ = 0;
};

/// The bytes before the HDF5 part of a recording (HDF5's "user block"), which hold one line of text with the
/// checksum (CRC-32) of all that follows. HDF5 crashes on some damaged files, so a damaged recording must be
/// known before HDF5 sees it.
inline constexpr std::size_t kUserBlockBytes = 512;

/// Writes the line into a recording that is finished and closed. Throws InputError if that fails.
void write_checksum(const std::filesystem::path& path);

/// `none`: an unfinished recording, or one that another program has rewritten. `our_own`: it is intact, and
/// what this process has written.
enum class Checksum : unsigned char { none, intact, broken, our_own };

/// Throws InputError if the file cannot be read.
Checksum check_checksum(const std::filesystem::path& path);

/// The description as attributes of the file's root, and its further settings as attributes of the group
/// /settings, the unit of KEY in the attribute KEY.unit. Labels, if there are any, are three attributes of
/// the group /labels each, VALUE.name, VALUE.colour ("#rrggbb") and VALUE.no_go (0 or 1). Failures are
/// InputErrors that name the file; under Hdf5Lock. Throws std::invalid_argument for a key that is empty,
/// stands twice or ends in ".unit".
void write_description(const std::filesystem::path& path, hid_t file, const RunDescription& description);
/// One more setting, of a new key.
void add_setting(const std::filesystem::path& path, hid_t file, const RunSetting& setting);
RunDescription read_description(const std::filesystem::path& path, hid_t file);

}  // namespace osteomill
