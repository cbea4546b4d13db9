#include "osteomill/recording/recording_file.h"

#include "osteomill/files/input_error.h"
#include "osteomill/recording/description_attributes.h"
#include "osteomill/recording/hdf5_attributes.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording_checksum.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr hsize_t kChunkRows = 1024;

hid_t file_type(ColumnType type) {
  switch (type) {
    case ColumnType::real:
      return H5T_IEEE_F64LE;
    case ColumnType::integer:
      return H5T_STD_I32LE;
    case ColumnType::small_integer:
      return H5T_STD_U8LE;
  }
  return H5I_INVALID_HID;
}

// The library's metadata reach the disk only when the file is flushed. Left to itself it also writes some of
// them whenever its cache is full, and a program killed between the two leaves a file that nobody can open.
bool keep_metadata_until_flush(hid_t file) {
  H5AC_cache_config_t config;
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  if (H5Fget_mdc_config(file, &config) < 0) return false;
  config.evictions_enabled = false;
  config.incr_mode = H5C_incr__off;
  config.flash_incr_mode = H5C_flash_incr__off;
  config.decr_mode = H5C_decr__off;
  return H5Fset_mdc_config(file, &config) >= 0;
}

}  // namespace

RecordingFile::RecordingFile(const fs::path& path, const RunDescription& description) : path_(path) {
  const Hdf5Lock lock;
  const Hdf5Handle layout(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(layout.get(), kUserBlockBytes);
  file_ = Hdf5Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, layout.get(), H5P_DEFAULT), H5Fclose);
  require(file_.valid(), "cannot be created");
  try {
    lay_out(description);
  } catch (...) {
    // Here, since the members go when the lock has gone.
    columns_.clear();
    cut_columns_.clear();
    file_.close();
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
}

void RecordingFile::lay_out(const RunDescription& description) {
  const AttributeWriter write(path_, file_.get());
  write.unsigned_integer("osteomill_recording_version", kRecordingVersion);
  write.unsigned_integer("complete", 0);
  write.unsigned_integer("dropped_records", 0);
  write_description(path_, file_.get(), description);
  create_columns();
  labels_ = description.labels;
  if (!labels_.empty()) create_cut_columns();
  const Hdf5Handle pictures(H5Gcreate2(file_.get(), "pictures", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                            H5Gclose);
  require(pictures.valid(), "the group of pictures cannot be written");
  require(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be written (is the disk full?)");
  require(keep_metadata_until_flush(file_.get()), "cannot be set up for writing");
}

RecordingFile::~RecordingFile() {
  const Hdf5Lock lock;
  columns_.clear();
  cut_columns_.clear();
  file_.close();
}

void RecordingFile::create_columns() {
  const Hdf5Handle group(H5Gcreate2(file_.get(), "columns", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  for (const RecordColumn& column : record_columns()) {
    columns_.push_back(create_column(group.get(), column.name, file_type(column.type), column.unit));
  }
}

void RecordingFile::create_cut_columns() {
  const Hdf5Handle group(H5Gopen2(file_.get(), "labels", H5P_DEFAULT), H5Gclose);
  cut_columns_.push_back(create_column(group.get(), "row", H5T_STD_U64LE, ""));
  cut_columns_.push_back(create_column(group.get(), "label", H5T_STD_I32LE, ""));
  cut_columns_.push_back(create_column(group.get(), "removed_mm3", H5T_IEEE_F64LE, "mm^3"));
}

Hdf5Handle RecordingFile::create_column(hid_t group, const char* name, hid_t type, const char* unit) const {
  const hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const Hdf5Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
  const Hdf5Handle chunked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(chunked.get(), 1, &kChunkRows);
  Hdf5Handle dataset(H5Dcreate2(group, name, type, space.get(), H5P_DEFAULT, chunked.get(), H5P_DEFAULT),
                     H5Dclose);
  require(dataset.valid(), "a column cannot be created");
  AttributeWriter(path_, dataset.get()).text("unit", unit);
  return dataset;
}

void RecordingFile::require(bool ok, const char* what) const {
  if (!ok) throw InputError(path_.string(), what);
}

void RecordingFile::append(std::span<const TickRecord> records) {
  if (records.empty()) return;
  const Hdf5Lock lock;
  values_.resize(records.size());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    for (std::size_t row = 0; row < records.size(); ++row) {
      values_[row] = record_columns()[c].get(records[row]);
    }
    append_values(columns_[c].get(), rows_);
  }
  if (!labels_.empty()) append_cuts(records);
  rows_ += records.size();
}

void RecordingFile::append_cuts(std::span<const TickRecord> records) {
  const auto append = [&](std::size_t column, const auto& value) {
    values_.clear();
    for (std::size_t n = 0; n < records.size(); ++n) {
      for (const LabelCut& cut : records[n].label_cuts) {
        if (cut.label != 0 && cut.label <= labels_.size()) values_.push_back(value(n, cut));
      }
    }
    if (!values_.empty()) append_values(cut_columns_[column].get(), cuts_);
  };
  append(0, [&](std::size_t n, const LabelCut&) { return static_cast<double>(rows_ + n); });
  append(1, [&](std::size_t, const LabelCut& cut) {
    return static_cast<double>(labels_[cut.label - 1u].value);
  });
  append(2, [](std::size_t, const LabelCut& cut) { return cut.removed_mm3; });
  cuts_ += values_.size();
}

// `values_` behind the rows that are there.
void RecordingFile::append_values(hid_t dataset, hsize_t rows) const {
  const hsize_t count = values_.size();
  const hsize_t all = rows + count;
  const Hdf5Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
  bool ok = H5Dset_extent(dataset, &all) >= 0;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  ok = ok && H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &rows, nullptr, &count, nullptr) >= 0;
  ok =
      ok && H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, values_.data()) >= 0;
  require(ok, "cannot be written (is the disk full?)");
}

void RecordingFile::flush(std::uint64_t dropped) {
  const Hdf5Lock lock;
  AttributeWriter(path_, file_.get()).replace_unsigned_integer("dropped_records", dropped);
  require(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be written (is the disk full?)");
}

void RecordingFile::add_picture(const std::string& name, std::span<const unsigned char> png) {
  const Hdf5Lock lock;
  const hsize_t size = png.size();
  const Hdf5Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const std::string place = "pictures/" + name;
  const Hdf5Handle dataset(H5Dcreate2(file_.get(), place.c_str(), H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose);
  require(dataset.valid() &&
              H5Dwrite(dataset.get(), H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, png.data()) >= 0,
          "a picture cannot be written (is the disk full?)");
}

void RecordingFile::finish(std::uint64_t dropped) {
  const Hdf5Lock lock;
  const AttributeWriter write(path_, file_.get());
  write.replace_unsigned_integer("dropped_records", dropped);
  write.replace_unsigned_integer("complete", 1);
  bool closed = true;
  for (std::vector<Hdf5Handle>* columns : {&columns_, &cut_columns_})
    for (Hdf5Handle& column : *columns) closed = column.close() && closed;
  closed = file_.close() && closed;
  require(closed, "cannot be written to its end (is the disk full?)");
  write_checksum(path_);
}

}  // namespace osteomill
