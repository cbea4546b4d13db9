#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/input_files.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording.h"
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

void require_our_version(const OpenRecording& recording, const Attributes& root) {
  if (!root.has("osteomill_recording_version")) refuse(recording, "is HDF5, but no recording of osteomill");
  const auto version = root.get<std::uint64_t>("osteomill_recording_version");
  if (version != kRecordingVersion && version != kRecordingVersionBefore) {
    refuse(recording, fmt::format("is a recording of version {}; this program reads versions {} and {}",
                                  version, kRecordingVersionBefore, kRecordingVersion));
  }
}

struct OpenColumn {
  std::string place;
  Hdf5Handle dataset;
  hsize_t width;
  std::size_t rows = 0;
};

// A dataset of `width` numbers a row. One that claims more than the file could hold is refused: a byte of
// file for each row lets through what other programs have compressed; of wide ones, whatever deflate may
// save.
OpenColumn open_column(const OpenRecording& recording, const std::string& place, hsize_t width = 1) {
  constexpr hsize_t kMostThatDeflateSaves = 1100;
  OpenColumn open{place, Hdf5Handle(H5Dopen2(recording.file.get(), place.c_str(), H5P_DEFAULT), H5Dclose),
                  width};
  if (!open.dataset.valid()) refuse(recording, "has no column '" + place + "'");
  const Hdf5Handle type(H5Dget_type(open.dataset.get()), H5Tclose);
  const H5T_class_t type_class = H5Tget_class(type.get());
  const Hdf5Handle space(H5Dget_space(open.dataset.get()), H5Sclose);
  const int rank = width == 1 ? 1 : 2;
  std::array<hsize_t, 2> size{0, 1};
  if ((type_class != H5T_FLOAT && type_class != H5T_INTEGER) ||
      H5Sget_simple_extent_ndims(space.get()) != rank ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) != rank || size[1] != width) {
    refuse(recording, "'" + place + "' is not a column of numbers");
  }
  const hsize_t most =
      rank == 1 ? recording.bytes : kMostThatDeflateSaves * recording.bytes / (width * sizeof(float));
  if (size[0] > most) {
    refuse(recording, fmt::format("'{}' claims {} rows, more than the file can hold", place, size[0]));
  }
  open.rows = size[0];
  return open;
}

// Of columns that belong together; of unequal lengths only where the recording is unfinished.
std::size_t common_rows(const OpenRecording& recording, std::span<const OpenColumn> columns, bool complete) {
  const OpenColumn& first = columns.front();
  std::size_t rows = first.rows;
  for (const OpenColumn& column : columns) {
    if (column.rows != first.rows && complete) {
      refuse(recording, fmt::format("the column '{}' has {} rows, '{}' has {}", column.place, column.rows,
                                    first.place, first.rows));
    }
    rows = std::min(rows, column.rows);
  }
  return rows;
}

void require_in_range(const OpenRecording& recording, const Field<TickRecord>& column, double value) {
  const bool is_missing = column.has(kMayBeMissing) && !std::isfinite(value);
  if (!is_missing && !column.range.contains(value))
    refuse(recording, fmt::format("the column '{}' holds {:g}", column.name, value));
}

template <typename Value>
std::vector<Value> read_values(const OpenRecording& recording, const OpenColumn& column) {
  std::vector<Value> values(column.rows * column.width);
  if (!values.empty() &&
      H5Dread(column.dataset.get(), memory_type<Value>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    refuse(recording, "the column '" + column.place + "' cannot be read");
  }
  return values;
}

std::vector<TickRecord> read_records(const OpenRecording& recording, bool complete) {
  std::vector<OpenColumn> columns;
  for (const Field<TickRecord>& column : fields_of<TickRecord>())
    columns.push_back(open_column(recording, "columns/" + column.name));
  std::vector<TickRecord> records(common_rows(recording, columns, complete));
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const Field<TickRecord>& column = fields_of<TickRecord>()[n];
    const auto values = read_values<double>(recording, columns[n]);
    for (std::size_t row = 0; row < records.size(); ++row) {
      require_in_range(recording, column, values[row]);
      column.set(records[row], values[row]);
    }
  }
  return records;
}

// Of one length.
template <typename Value, std::size_t kCount>
std::array<std::vector<Value>, kCount> read_together(const OpenRecording& recording, bool complete,
                                                     const std::array<const char*, kCount>& places) {
  std::vector<OpenColumn> columns;
  for (const char* place : places) columns.push_back(open_column(recording, place));
  const std::size_t rows = common_rows(recording, columns, complete);
  std::array<std::vector<Value>, kCount> values;
  for (std::size_t n = 0; n < kCount; ++n) {
    values[n] = read_values<Value>(recording, columns[n]);
    values[n].resize(rows);
  }
  return values;
}

void put_cut(const OpenRecording& recording, const std::vector<Label>& labels, double value,
             double removed_mm3, TickRecord& record) {
  const auto label =
      std::ranges::find(labels, value, [](const Label& l) { return static_cast<double>(l.value); });
  const auto free = std::ranges::find(record.label_cuts, 0, &LabelCut::label);
  if (label == labels.end() || free == record.label_cuts.end()) {
    refuse(recording, "has a cut of a label that cannot be");
  }
  *free = {static_cast<LabelMap::Place>(label - labels.begin() + 1), removed_mm3};
}

// What ticks cut of labels goes into their records.
void read_cuts(const OpenRecording& recording, const std::vector<Label>& labels, bool complete,
               std::vector<TickRecord>& records) {
  if (labels.empty()) return;
  const auto [rows, values, removed_mm3] =
      read_together<double, 3>(recording, complete, {"labels/row", "labels/label", "labels/removed_mm3"});
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (rows[n] >= 0 && rows[n] < static_cast<double>(records.size())) {
      put_cut(recording, labels, values[n], removed_mm3[n], records[static_cast<std::size_t>(rows[n])]);
    } else if (complete) {
      refuse(recording, "has a cut of a label in a row that is not there");
    }
  }
}

std::vector<BoneHash> read_hashes(const OpenRecording& recording, bool complete, std::size_t records) {
  const auto [rows, values] =
      read_together<std::uint64_t, 2>(recording, complete, {"bone_hash/row", "bone_hash/hash"});
  std::vector<BoneHash> hashes;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool there = rows[n] < records && (n == 0 || rows[n] > rows[n - 1]);
    if (!there && complete) refuse(recording, "has a hash of the bone in a row that is not there");
    if (there) hashes.push_back({rows[n], values[n]});
  }
  return hashes;
}

std::vector<DensityBlock> read_bricks(const OpenRecording& recording, const std::string& session,
                                      const std::array<int, 3>& dims) {
  if (H5Lexists(recording.file.get(), (session + "/brick_first").c_str(), H5P_DEFAULT) <= 0) return {};
  constexpr std::size_t kDensities = std::tuple_size_v<decltype(DensityBlock::densities)>;
  const OpenColumn firsts = open_column(recording, session + "/brick_first", 3);
  const OpenColumn bones = open_column(recording, session + "/brick_densities", kDensities);
  const auto first = read_values<std::int32_t>(recording, firsts);
  const auto densities = read_values<float>(recording, bones);
  std::vector<DensityBlock> bricks(first.size() / 3);
  bool right = densities.size() == bricks.size() * kDensities &&
               std::ranges::all_of(densities, [](float density) { return std::isfinite(density); });
  for (std::size_t n = 0; right && n < bricks.size(); ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int voxel = first[3 * n + axis];
      right = right && voxel >= 0 && voxel < dims[axis] && voxel % DensityBlock::kVoxels == 0;
    }
    bricks[n].first = {first[3 * n], first[3 * n + 1], first[3 * n + 2]};
    std::copy_n(densities.data() + n * kDensities, kDensities, bricks[n].densities.begin());
  }
  if (!right) refuse(recording, "has bricks of a bone that cannot be");
  return bricks;
}

SessionStart read_session_start(const OpenRecording& recording, hid_t group, const std::string& place,
                                const RunDescription* run) {
  const Attributes read(recording.path, group);
  SessionStart start;
  start.run = run != nullptr ? *run : read_description(recording.path, group);
  read.get("goes_on_from", start.goes_on_from);
  read.get("removed_mm3", start.removed_mm3);
  start.taken_over.sent = {read.get<Vec3>("force_N"), read.get<Vec3>("torque_Nmm")};
  if (read.has("tool_mm")) {
    std::array<double, 4> q{};
    read.get_reals("tool_wxyz", q);
    start.taken_over.X_WT = Pose{read.get<Vec3>("tool_mm"), Quat(q[0], q[1], q[2], q[3])};
  }
  start.bricks = read_bricks(recording, place, start.run.dims);
  return start;
}

// Of an unfinished recording only those of which records are there.
std::vector<RecordedSession> read_sessions(const OpenRecording& open, const Recording& recording) {
  std::vector<RecordedSession> sessions;
  for (;;) {
    const std::string place = "sessions/" + std::to_string(sessions.size());
    if (H5Lexists(open.file.get(), place.c_str(), H5P_DEFAULT) <= 0) break;
    const Hdf5Handle group(H5Gopen2(open.file.get(), place.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.valid()) refuse(open, "'" + place + "' cannot be opened");
    const auto row = Attributes(open.path, group.get()).get<std::uint64_t>("row");
    const bool right = sessions.empty() ? row == 0 : row >= sessions.back().first;
    if (!recording.complete && row >= recording.records.size() && !sessions.empty()) break;
    if (!right || row > recording.records.size()) refuse(open, "'" + place + "' begins where it cannot");
    const RunDescription* first = sessions.empty() ? &recording.description : nullptr;
    sessions.push_back({row, read_session_start(open, group.get(), place, first)});
    sessions.back().start.run.labels = recording.description.labels;
  }
  if (sessions.empty() && !recording.records.empty()) refuse(open, "has ticks of no session");
  return sessions;
}

void number_records(Recording& recording) {
  std::uint32_t session = 0;
  for (std::size_t row = 0; row < recording.records.size(); ++row) {
    while (session + 1 < recording.sessions.size() && recording.sessions[session + 1].first <= row) ++session;
    recording.records[row].session = session;
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
    const OpenColumn png = open_column(recording, "pictures/" + name);
    pictures.push_back({name, read_values<unsigned char>(recording, png)});
  }
  return pictures;
}

// HDF5 would follow links into other files, look for values there, and load plug-ins that a file asks for.
bool holds_its_own_values(hid_t dataset) {
  const Hdf5Handle layout(H5Dget_create_plist(dataset), H5Pclose);
  bool own = H5Pget_external_count(layout.get()) == 0 && H5Pget_layout(layout.get()) != H5D_VIRTUAL;
  for (int n = 0; own && n < H5Pget_nfilters(layout.get()); ++n) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(layout.get(), static_cast<unsigned>(n), &flags, &values, nullptr, 0, nullptr, &config);
    own = filter >= 0 && filter < H5Z_FILTER_RESERVED;
  }
  return own;
}

void require_nothing_elsewhere(const OpenRecording& recording) {
  std::string refused;
  const auto look = [](hid_t group, const char* name, const H5L_info_t* link, void* found) -> herr_t {
    bool within = link->type == H5L_TYPE_HARD;
    if (within) {
      const Hdf5Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
      const H5I_type_t type = H5Iget_type(object.get());
      within = type == H5I_GROUP || (type == H5I_DATASET && holds_its_own_values(object.get()));
    }
    if (!within) *static_cast<std::string*>(found) = name;
    return within ? 0 : 1;
  };
  if (H5Lvisit(recording.file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, look, &refused) != 0)
    refuse(recording, "'" + refused + "' leads elsewhere, or needs a filter that is not HDF5's own");
}

Recording read_open_file(const fs::path& path) {
  const OpenRecording open = open_recording(path);
  require_nothing_elsewhere(open);
  const Attributes root(path, open.file.get());
  require_our_version(open, root);
  Recording recording;
  recording.path = path;
  recording.complete = root.get<std::uint64_t>("complete") != 0;
  root.get("dropped_records", recording.dropped);
  recording.description = read_description(path, open.file.get());
  recording.records = read_records(open, recording.complete);
  read_cuts(open, recording.description.labels, recording.complete, recording.records);
  recording.bone_hashes = read_hashes(open, recording.complete, recording.records.size());
  recording.sessions = read_sessions(open, recording);
  number_records(recording);
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

Recording read_checked(const fs::path& path) {
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

}  // namespace

Recording read_recording(const fs::path& path) {
  Recording recording = read_checked(path);
  note_input(path);
  return recording;
}

SessionStart read_start(const fs::path& path) {
  Recording recording = read_checked(path);
  if (recording.sessions.empty()) throw InputError(path.string(), "holds nothing to go on from");
  return std::move(recording.sessions.front().start);
}

Recording read_with_what_came_before(const fs::path& path) {
  Recording recording = read_recording(path);
  if (recording.sessions.empty() || recording.sessions.front().start.goes_on_from.empty()) return recording;
  const fs::path name = recording.sessions.front().start.goes_on_from;
  if (name != name.filename()) throw InputError(path.string(), "goes on from a recording elsewhere");
  if (std::error_code error; !fs::exists(path.parent_path() / name, error))
    throw InputError(path.string(), "goes on from " + name.string() + ", which is not beside it");
  Recording whole = read_recording(path.parent_path() / name);
  const bool begins = !whole.sessions.empty() && whole.sessions.front().start.goes_on_from.empty();
  if (!begins || whole.description.scan_hash != recording.description.scan_hash) {
    throw InputError(path.string(), "goes on from " + name.string() + ", which is not what came before it");
  }
  const std::size_t before = whole.records.size();
  const std::size_t sessions_before = whole.sessions.size();
  for (auto session = recording.sessions.begin() + 1; session != recording.sessions.end(); ++session)
    whole.sessions.push_back({before + session->first, std::move(session->start)});
  for (const BoneHash& hash : recording.bone_hashes)
    whole.bone_hashes.push_back({before + hash.record, hash.hash});
  for (TickRecord& record : recording.records) {
    record.session += static_cast<std::uint32_t>(sessions_before - 1);
    whole.records.push_back(record);
  }
  whole.path = path;
  whole.pictures = std::move(recording.pictures);
  whole.complete = whole.complete && recording.complete;
  whole.dropped += recording.dropped;
  return whole;
}

bool is_hdf5(const fs::path& path) {
  const Hdf5Lock lock;
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && H5Fis_hdf5(path.c_str()) > 0;
}

namespace {

bool is_run_alike(const RunDescription& a, const RunDescription& b) {
  const auto settings = [](const RunDescription& run) {
    std::vector<RunSetting> those = run.settings;
    // Not what was set: how the program was called, and what the algorithm made of it.
    std::erase_if(those, [](const RunSetting& setting) {
      return setting.key == kCommandLineKey || setting.key == kSamplePointsKey;
    });
    return those;
  };
  return a.algorithm == b.algorithm && a.isovalue == b.isovalue && a.tool == b.tool &&
         settings(a) == settings(b);
}

}  // namespace

std::vector<Recording> in_stretches(Recording recording) {
  std::vector<std::size_t> first{0};
  const std::vector<RecordedSession>& sessions = recording.sessions;
  for (std::size_t n = 1; n < sessions.size(); ++n) {
    if (sessions[n].first > sessions[first.back()].first &&
        !is_run_alike(sessions[n - 1].start.run, sessions[n].start.run))
      first.push_back(n);
  }
  std::vector<Recording> stretches;
  if (first.size() < 2) {
    stretches.push_back(std::move(recording));
    return stretches;
  }
  for (std::size_t n = 0; n < first.size(); ++n) {
    const RecordedSession& begin = sessions[first[n]];
    const bool last = n + 1 == first.size();
    const std::size_t end = last ? recording.records.size() : sessions[first[n + 1]].first;
    if (begin.first == end) continue;
    Recording stretch{.path = recording.path, .description = begin.start.run};
    stretch.description.phase = "part " + std::to_string(n + 1);
    stretch.records.assign(recording.records.begin() + static_cast<std::ptrdiff_t>(begin.first),
                           recording.records.begin() + static_cast<std::ptrdiff_t>(end));
    stretch.complete = recording.complete;
    stretch.dropped = n == 0 ? recording.dropped : 0;
    stretches.push_back(std::move(stretch));
  }
  for (const RunPicture& picture : recording.pictures) {
    Recording& shown = picture.name == kPictureBefore ? stretches.front() : stretches.back();
    shown.pictures.push_back(picture);
  }
  return stretches;
}

}  // namespace osteomill
