#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "osteomill/recording/hdf5_handle.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// The version of the layout, in the root's attribute `osteomill_recording_version`.
inline constexpr std::uint64_t kRecordingVersion = 2;

/// A recording being written, from one thread at a time. Root: the description's attributes, `complete` (0
/// until `finish`) and `dropped_records`; /columns: a dataset a column (record_columns.h), each with its
/// `unit`; /labels: see description_attributes.h, and what ticks cut of them; /settings: see
/// description_attributes.h; /pictures: the bytes of PNG files. A finished file begins with its checksum
/// (recording_seal.h). Every failure is an InputError that names `path`.
class RecordingFile {
 public:
  /// Creates the file, over one that is there.
  RecordingFile(const std::filesystem::path& path, const RunDescription& description);
  /// Closes the file as it is: readable, and not marked complete unless `finish` came first.
  ~RecordingFile();
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  void append(std::span<const TickRecord> records);
  /// What was appended so far survives the end of this program, however it ends.
  void flush(std::uint64_t dropped);
  void add_picture(const std::string& name, std::span<const unsigned char> png);
  /// Marks the recording complete, closes the file and writes its checksum.
  void finish(std::uint64_t dropped);

 private:
  void lay_out(const RunDescription& description);
  void create_columns();
  void create_cut_columns();
  Hdf5Handle create_column(hid_t group, const char* name, hid_t type, const char* unit) const;
  void append_cuts(std::span<const TickRecord> records);
  void append_values(hid_t dataset, hsize_t rows) const;
  void require(bool ok, const char* what) const;

  std::filesystem::path path_;
  Hdf5Handle file_;
  std::vector<Hdf5Handle> columns_;
  // What was cut of labels: row, label, removed_mm3; empty where the bone has none.
  std::vector<Hdf5Handle> cut_columns_;
  std::vector<Label> labels_;
  hsize_t cuts_ = 0;
  std::vector<double> values_;
  hsize_t rows_ = 0;
};

}  // namespace osteomill
