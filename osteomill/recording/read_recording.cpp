#include "osteomill/recording/read_recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/files/input_error.h"
#include "osteomill/recording/description_attributes.h"
#include "osteomill/recording/hdf5_attributes.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording_checksum.h"
#include "osteomill/recording/recording_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

struct OpenRecording {
  fs::path path;
  std::uintmax_t bytes;
  Hdf5Handle file;
};

[[noreturn]] void refuse(const OpenRecording& recording, const std::string& reason) {
  throw InputError(recording.path.string(), reason);
}

OpenRecording open_recording(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (H5Fis_hdf5(path.c_str()) <= 0) throw InputError(path.string(), "is not an HDF5 file, so no recording");
  OpenRecording recording{path, bytes,
                          Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose)};
  if (!recording.file.valid()) {
    refuse(recording, "cannot be opened: it is cut short, damaged, or still being written");
  }
  return recording;
}

void require_our_version(const OpenRecording& recording, const AttributeReader& root) {
  if (!root.has("osteomill_recording_version")) refuse(recording, "is HDF5, but no recording of osteomill");
  const std::uint64_t version = root.unsigned_integer("osteomill_recording_version");
  if (version != kRecordingVersion) {
    refuse(recording, "is a recording of version " + std::to_string(version) +
                          "; this program reads version " + std::to_string(kRecordingVersion));
  }
}

// The length of a dataset of one dimension that holds numbers and, claiming more than the file could hold, is
// refused. A byte of file for each number lets through what other programs have compressed.
std::size_t checked_length(const OpenRecording& recording, hid_t dataset, const std::string& name) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const H5T_class_t type_class = H5Tget_class(type.get());
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if ((type_class != H5T_FLOAT && type_class != H5T_INTEGER) ||
      H5Sget_simple_extent_ndims(space.get()) != 1) {
    refuse(recording, "'" + name + "' is not a column of numbers");
  }
  hsize_t length = 0;
  H5Sget_simple_extent_dims(space.get(), &length, nullptr);
  if (length > recording.bytes) {
    refuse(recording,
           "'" + name + "' claims " + std::to_string(length) + " rows, more than the file can hold");
  }
  return static_cast<std::size_t>(length);
}

struct OpenColumn {
  const RecordColumn* column;
  Hdf5Handle dataset;
  std::size_t rows;
};

std::vector<OpenColumn> open_columns(const OpenRecording& recording) {
  std::vector<OpenColumn> columns;
  for (const RecordColumn& column : record_columns()) {
    const std::string place = std::string("columns/") + column.name;
    Hdf5Handle dataset(H5Dopen2(recording.file.get(), place.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid() && column.may_lack) continue;
    if (!dataset.valid()) refuse(recording, std::string("has no column '") + column.name + "'");
    const std::size_t rows = checked_length(recording, dataset.get(), column.name);
    columns.push_back({&column, std::move(dataset), rows});
  }
  return columns;
}

std::size_t row_count(const OpenRecording& recording, const std::vector<OpenColumn>& columns, bool complete) {
  std::size_t rows = columns.front().rows;
  for (const OpenColumn& open : columns) {
    if (open.rows != rows && complete) {
      refuse(recording, std::string("the column '") + open.column->name + "' has " +
                            std::to_string(open.rows) + " rows, '" + columns.front().column->name + "' has " +
                            std::to_string(columns.front().rows));
    }
    rows = std::min(rows, open.rows);
  }
  return rows;
}

void require_in_range(const OpenRecording& recording, const RecordColumn& column, double value) {
  const double max = column.type == ColumnType::small_integer ? static_cast<double>(WrenchFault::eased)
                                                              : std::numeric_limits<int>::max();
  if (column.type != ColumnType::real && !(value >= 0 && value <= max && value == std::floor(value))) {
    refuse(recording, std::string("the column '") + column.name + "' holds " + std::to_string(value));
  }
}

std::vector<double> read_values(const OpenRecording& recording, hid_t dataset, const std::string& name,
                                hsize_t rows) {
  std::vector<double> values(rows);
  const hsize_t from = 0;
  const Hdf5Handle memory(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if (rows > 0 &&
      (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &from, nullptr, &rows, nullptr) < 0 ||
       H5Dread(dataset, H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, values.data()) < 0)) {
    refuse(recording, "the column '" + name + "' cannot be read");
  }
  return values;
}

std::vector<TickRecord> read_records(const OpenRecording& recording, bool complete) {
  const std::vector<OpenColumn> columns = open_columns(recording);
  const hsize_t rows = row_count(recording, columns, complete);
  std::vector<TickRecord> records(rows);
  for (const OpenColumn& open : columns) {
    const std::vector<double> values = read_values(recording, open.dataset.get(), open.column->name, rows);
    for (std::size_t row = 0; row < records.size(); ++row) {
      require_in_range(recording, *open.column, values[row]);
      open.column->set(records[row], values[row]);
    }
  }
  return records;
}

void put_cut(const OpenRecording& recording, const std::vector<Label>& labels, double value,
             double removed_mm3, TickRecord& record) {
  const auto label = std::find_if(labels.begin(), labels.end(), [&](const Label& known) {
    return static_cast<double>(known.value) == value;
  });
  const auto free = std::find_if(record.label_cuts.begin(), record.label_cuts.end(),
                                 [](const LabelCut& cut) { return cut.label == 0; });
  if (label == labels.end() || free == record.label_cuts.end()) {
    refuse(recording, "has a cut of a label that cannot be");
  }
  *free = {static_cast<LabelMap::Place>(label - labels.begin() + 1), removed_mm3};
}

// What ticks cut of labels goes into their records.
void read_cuts(const OpenRecording& recording, const std::vector<Label>& labels, bool complete,
               std::vector<TickRecord>& records) {
  if (labels.empty()) return;
  constexpr std::array kNames{"row", "label", "removed_mm3"};
  std::array<Hdf5Handle, kNames.size()> datasets;
  std::array<std::vector<double>, kNames.size()> columns;
  std::array<std::size_t, kNames.size()> lengths{};
  for (std::size_t n = 0; n < kNames.size(); ++n) {
    const std::string name = std::string("labels/") + kNames[n];
    datasets[n] = Hdf5Handle(H5Dopen2(recording.file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!datasets[n].valid()) refuse(recording, "has no column '" + name + "'");
    lengths[n] = checked_length(recording, datasets[n].get(), name);
  }
  const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
  if (complete && *least != *most) refuse(recording, "has columns of unequal lengths in 'labels'");
  for (std::size_t n = 0; n < kNames.size(); ++n)
    columns[n] = read_values(recording, datasets[n].get(), kNames[n], *least);
  for (std::size_t n = 0; n < *least; ++n) {
    const double row = columns[0][n];
    if (row >= 0 && row < static_cast<double>(records.size())) {
      put_cut(recording, labels, columns[1][n], columns[2][n], records[static_cast<std::size_t>(row)]);
    } else if (complete) {
      refuse(recording, "has a cut of a label in a row that is not there");
    }
  }
}

std::vector<std::string> picture_names(const OpenRecording& recording, hid_t group) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0) {
    refuse(recording, "its pictures cannot be listed");
  }
  return names;
}

std::vector<RunPicture> read_pictures(const OpenRecording& recording) {
  const Hdf5Handle group(H5Gopen2(recording.file.get(), "pictures", H5P_DEFAULT), H5Gclose);
  if (!group.valid()) refuse(recording, "has no group of pictures");
  std::vector<RunPicture> pictures;
  for (const std::string& name : picture_names(recording, group.get())) {
    const Hdf5Handle dataset(H5Dopen2(group.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) refuse(recording, "the picture '" + name + "' cannot be opened");
    RunPicture picture{name, std::vector<unsigned char>(checked_length(recording, dataset.get(), name))};
    if (!picture.png.empty() &&
        H5Dread(dataset.get(), H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, picture.png.data()) < 0) {
      refuse(recording, "the picture '" + name + "' cannot be read");
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

Recording read_open_file(const fs::path& path) {
  const OpenRecording open = open_recording(path);
  const AttributeReader root(path, open.file.get());
  require_our_version(open, root);
  Recording recording;
  recording.path = path;
  recording.complete = root.unsigned_integer("complete") != 0;
  recording.dropped = root.unsigned_integer("dropped_records");
  recording.description = read_description(path, open.file.get());
  recording.records = read_records(open, recording.complete);
  read_cuts(open, recording.description.labels, recording.complete, recording.records);
  recording.pictures = read_pictures(open);
  return recording;
}

// HDF5 ends the program on some damaged files, or never comes back. Where no checksum tells them, another
// process tries first.
void try_in_child(const fs::path& path) {
  constexpr unsigned kMax_s = 60;
  const ::pid_t child = ::fork();
  if (child == 0) {
    ::alarm(kMax_s);
    try {
      read_open_file(path);
    } catch (...) {
      // It will be said by who reads it next.
    }
    ::_exit(0);
  }
  int status = 0;
  if (child > 0 && ::waitpid(child, &status, 0) == child && status != 0)
    throw InputError(path.string(), "is damaged: it ends the program that reads it");
}

}  // namespace

Recording read_recording(const fs::path& path) {
  const Hdf5Lock lock;
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path.string(), "no such file");
  if (!fs::is_regular_file(path, error)) throw InputError(path.string(), "is not a file");
  const Checksum checksum = check_checksum(path);
  if (checksum == Checksum::broken) {
    throw InputError(path.string(), "is damaged or cut short: its checksum is not that of its content");
  }
  if (checksum == Checksum::none) try_in_child(path);
  return read_open_file(path);
}

}  // namespace osteomill
