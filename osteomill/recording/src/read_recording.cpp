#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/read_hdf5.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording.h"

#include "recording_file.h"

namespace osteomill {

namespace fs = std::filesystem;

template <>
inline constexpr bool kFlat<ViewSample> = true;

// Members that the reading process passes through the pipe.
static auto members_of(RunSetting& setting) {
  return std::tie(setting.key, setting.value, setting.unit);
}
static auto members_of(Label& label) {
  return std::tie(label.value, label.name, label.colour, label.no_go);
}
static void pass(PipeEnd& pipe, RunDescription& run) {
  visit_attributes(run, [&](const RunAttribute&, auto&& value) {
    // A matrix column is a temporary and needs storage to pass from and to.
    std::conditional_t<std::is_lvalue_reference_v<decltype(value)>, decltype(value), Vec3> held = value;
    pass(pipe, held);
    value = held;
  });
  pass(pipe, run.settings);
  pass(pipe, run.labels);
}
static auto members_of(SessionStart& start) {
  return std::tie(start.run, start.handover.X_WT, start.handover.sent, start.handover.held_back,
                  start.handover.spindle_rpm, start.removed_mm3, start.bricks, start.piece_drops,
                  start.continues_from, start.continues_after);
}
static auto members_of(RecordedSession& session) {
  return std::tie(session.first, session.start);
}
static auto members_of(RunPicture& picture) {
  return std::tie(picture.name, picture.png);
}
static auto members_of(Recording& recording) {
  return std::tie(recording.description, recording.sessions, recording.bone_hashes, recording.records,
                  recording.views, recording.pictures, recording.complete, recording.dropped);
}

namespace {

void require_our_version(const Hdf5File& recording, const Attributes& root) {
  if (!root.has("osteomill_recording_version"))
    recording.refuse("is an HDF5 file but not an osteomill recording");
  const auto version = root.get<std::uint64_t>("osteomill_recording_version");
  if (version != kRecordingVersion && version != kPreviousRecordingVersion) {
    recording.refuse(fmt::format("is a recording of version {}; this program reads versions {} and {}",
                                 version, kPreviousRecordingVersion, kRecordingVersion));
  }
}

// Returns the common number of rows of related columns; throws InputError if they differ, unless the
// recording is unfinished.
std::size_t common_rows(const Hdf5File& recording, std::span<const Hdf5Column> columns, bool complete) {
  const Hdf5Column& first = columns.front();
  std::size_t rows = first.rows;
  for (const Hdf5Column& column : columns) {
    if (column.rows != first.rows && complete) {
      recording.refuse(fmt::format("the column '{}' has {} rows, '{}' has {}", column.place, column.rows,
                                   first.place, first.rows));
    }
    rows = std::min(rows, column.rows);
  }
  return rows;
}

void require_in_range(const Hdf5File& recording, const FieldDescription& column, double value) {
  const bool is_missing = column.has(kMayBeNotFinite) && !std::isfinite(value);
  if (!is_missing && !column.range.contains(value))
    recording.refuse(fmt::format("the column '{}' holds {:g}", column.name, value));
}

// Reads a group with one column per field.
template <typename Struct>
std::vector<Struct> read_rows(const Hdf5File& recording, bool complete, const std::string& group) {
  std::vector<Hdf5Column> columns;
  std::vector<const Field<Struct>*> fields;
  for (const Field<Struct>& column : fields_of<Struct>()) {
    const std::string place = group + "/" + column.name;
    if (column.has(kMayBeAbsent) && H5Lexists(recording.id(), place.c_str(), H5P_DEFAULT) <= 0) continue;
    columns.push_back(open_column(recording, place));
    fields.push_back(&column);
  }
  std::vector<Struct> records(common_rows(recording, columns, complete));
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const Field<Struct>& column = *fields[n];
    const auto values = read_values<double>(recording, columns[n]);
    for (std::size_t row = 0; row < records.size(); ++row) {
      require_in_range(recording, column, values[row]);
      column.set(records[row], values[row]);
    }
  }
  return records;
}

// Reads columns of one length.
template <typename Value, std::size_t kCount>
std::array<std::vector<Value>, kCount> read_columns(const Hdf5File& recording, bool complete,
                                                    const std::array<const char*, kCount>& places) {
  std::vector<Hdf5Column> columns;
  for (const char* place : places) columns.push_back(open_column(recording, place));
  const std::size_t rows = common_rows(recording, columns, complete);
  std::array<std::vector<Value>, kCount> values;
  for (std::size_t n = 0; n < kCount; ++n) {
    values[n] = read_values<Value>(recording, columns[n]);
    values[n].resize(rows);
  }
  return values;
}

void put_cut(const Hdf5File& recording, const std::vector<Label>& labels, double value, double removed_mm3,
             TickRecord& record) {
  const auto label =
      std::ranges::find(labels, value, [](const Label& l) { return static_cast<double>(l.value); });
  const auto free = std::ranges::find(record.label_cuts, 0, &LabelCut::label);
  if (label == labels.end() || free == record.label_cuts.end()) {
    recording.refuse("has a cut of an invalid label");
  }
  *free = {static_cast<LabelMap::LabelIndex>(label - labels.begin() + 1), removed_mm3};
}

// Assigns the cuts by label to the records of their ticks.
void read_cuts(const Hdf5File& recording, const std::vector<Label>& labels, bool complete,
               std::vector<TickRecord>& records) {
  if (labels.empty()) return;
  const auto [rows, values, removed_mm3] =
      read_columns<double, 3>(recording, complete, {"labels/row", "labels/label", "labels/removed_mm3"});
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (rows[n] >= 0 && rows[n] < static_cast<double>(records.size())) {
      put_cut(recording, labels, values[n], removed_mm3[n], records[static_cast<std::size_t>(rows[n])]);
    } else if (complete) {
      recording.refuse("has a cut of a label in a row that does not exist");
    }
  }
}

std::vector<BoneHash> read_hashes(const Hdf5File& recording, bool complete, std::size_t records) {
  const auto [rows, values] =
      read_columns<std::uint64_t, 2>(recording, complete, {"bone_hash/row", "bone_hash/hash"});
  std::vector<BoneHash> hashes;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const bool there = rows[n] < records && (n == 0 || rows[n] > rows[n - 1]);
    if (!there && complete) recording.refuse("has a hash of the bone in a row that does not exist");
    if (there) hashes.push_back({rows[n], values[n]});
  }
  return hashes;
}

std::vector<DensityBlock> read_bricks(const Hdf5File& recording, const std::string& session,
                                      const std::array<int, 3>& dims) {
  if (H5Lexists(recording.id(), (session + "/brick_first").c_str(), H5P_DEFAULT) <= 0) return {};
  constexpr std::size_t kDensities = std::tuple_size_v<decltype(DensityBlock::densities)>;
  const Hdf5Column firsts = open_column(recording, session + "/brick_first", 3);
  const Hdf5Column bones = open_column(recording, session + "/brick_densities", kDensities);
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
  if (!right) recording.refuse("has invalid bricks of bone");
  return bricks;
}

SessionStart read_session_start(const Hdf5File& recording, hid_t group, const std::string& place,
                                const RunDescription* run) {
  const Attributes read(recording.path, group);
  SessionStart start;
  start.run = run != nullptr ? *run : read_description(recording.path, group);
  read.get("goes_on_from", start.continues_from);
  if (read.has("goes_on_after")) read.get("goes_on_after", start.continues_after);
  read.get("removed_mm3", start.removed_mm3);
  start.handover.sent = {read.get<Vec3>("force_N"), read.get<Vec3>("torque_Nmm")};
  start.handover.held_back = read.has("held_back") && read.get<std::uint64_t>("held_back") != 0;
  if (read.has("spindle_rpm")) start.handover.spindle_rpm = read.get<double>("spindle_rpm");
  if (read.has("tool_mm")) {
    std::array<double, 4> q{};
    read.get_reals("tool_wxyz", q);
    start.handover.X_WT = Pose{read.get<Vec3>("tool_mm"), Quat(q[0], q[1], q[2], q[3])};
  }
  start.bricks = read_bricks(recording, place, start.run.dims);
  return start;
}

// Reads the sessions; from an unfinished recording, only those with records.
std::vector<RecordedSession> read_sessions(const Hdf5File& open, const Recording& recording) {
  std::vector<RecordedSession> sessions;
  for (;;) {
    const std::string place = "sessions/" + std::to_string(sessions.size());
    if (H5Lexists(open.id(), place.c_str(), H5P_DEFAULT) <= 0) break;
    const Hdf5Handle group(H5Gopen2(open.id(), place.c_str(), H5P_DEFAULT), H5Gclose);
    if (!group.valid()) open.refuse("'" + place + "' cannot be opened");
    const auto row = Attributes(open.path, group.get()).get<std::uint64_t>("row");
    const bool right = sessions.empty() ? row == 0 : row >= sessions.back().first;
    if (!recording.complete && row >= recording.records.size() && !sessions.empty()) break;
    if (!right || row > recording.records.size()) open.refuse("'" + place + "' begins at a wrong row");
    const RunDescription* first = sessions.empty() ? &recording.description : nullptr;
    sessions.push_back({row, read_session_start(open, group.get(), place, first)});
    SessionStart& start = sessions.back().start;
    start.run.labels = recording.description.labels;
    if (const Attributes read(open.path, group.get()); read.has("piece_drops")) {
      start.piece_drops.resize(start.run.labels.size() + 1);
      read.get_reals("piece_drops", start.piece_drops);
    }
  }
  if (sessions.empty() && !recording.records.empty()) open.refuse("has ticks without a session");
  return sessions;
}

void number_records(Recording& recording) {
  std::uint32_t session = 0;
  for (std::size_t row = 0; row < recording.records.size(); ++row) {
    while (session + 1 < recording.sessions.size() && recording.sessions[session + 1].first <= row) ++session;
    recording.records[row].session = session;
  }
}

std::vector<std::string> picture_names(const Hdf5File& recording, hid_t group) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0) {
    recording.refuse("its pictures cannot be listed");
  }
  return names;
}

std::vector<RunPicture> read_pictures(const Hdf5File& recording) {
  const Hdf5Handle group(H5Gopen2(recording.id(), "pictures", H5P_DEFAULT), H5Gclose);
  if (!group.valid()) recording.refuse("has no group of pictures");
  std::vector<RunPicture> pictures;
  for (const std::string& name : picture_names(recording, group.get())) {
    const Hdf5Column png = open_column(recording, "pictures/" + name);
    pictures.push_back({name, read_values<unsigned char>(recording, png)});
  }
  return pictures;
}

Recording read_open_file(const Hdf5File& open) {
  const fs::path& path = open.path;
  const Attributes root(path, open.id());
  require_our_version(open, root);
  Recording recording;
  recording.path = path;
  recording.complete = root.get<std::uint64_t>("complete") != 0;
  root.get("dropped_records", recording.dropped);
  recording.description = read_description(path, open.id());
  recording.records = read_rows<TickRecord>(open, recording.complete, "columns");
  if (H5Lexists(open.id(), "view", H5P_DEFAULT) > 0)
    recording.views = read_rows<ViewSample>(open, recording.complete, "view");
  read_cuts(open, recording.description.labels, recording.complete, recording.records);
  recording.bone_hashes = read_hashes(open, recording.complete, recording.records.size());
  recording.sessions = read_sessions(open, recording);
  number_records(recording);
  recording.pictures = read_pictures(open);
  return recording;
}

Recording read_checked(const fs::path& path) {
  require_readable(path);
  const Checksum checksum = check_checksum(path);
  if (checksum == Checksum::broken)
    throw InputError(path.string(), "is damaged or truncated: wrong checksum; restore it from a backup");
  if (checksum == Checksum::our_own) {
    const Hdf5Lock lock;
    return read_open_file(open_hdf5(path));
  }
  Recording recording = read_hdf5(path, read_open_file);
  recording.path = path;
  return recording;
}

}  // namespace

Recording read_recording(const fs::path& path) {
  Recording recording = read_checked(path);
  register_input(path);
  return recording;
}

SessionStart read_start(const fs::path& path) {
  Recording recording = read_checked(path);
  if (recording.sessions.empty()) throw InputError(path.string(), "holds no session to continue");
  return std::move(recording.sessions.front().start);
}

namespace {

// Truncates a recording to its first ticks.
void keep_first_ticks(Recording& recording, std::size_t ticks) {
  recording.records.resize(ticks);
  std::erase_if(recording.sessions, [&](const RecordedSession& session) { return session.first >= ticks; });
  std::erase_if(recording.bone_hashes, [&](const BoneHash& hash) { return hash.record >= ticks; });
  const double last_s = recording.records.back().time_s;
  std::erase_if(recording.views, [&](const ViewSample& view) { return view.time_s > last_s; });
  recording.complete = true;
}

// Reads a recording and those that it continues. `later` holds the canonical paths of the recordings that
// continue it.
Recording read_chain(const fs::path& path, std::vector<fs::path> later) {
  constexpr std::size_t kMost = 64;
  Recording recording = read_recording(path);
  if (recording.sessions.empty() || recording.sessions.front().start.continues_from.empty()) return recording;
  const fs::path name = recording.sessions.front().start.continues_from;
  if (name != name.filename())
    throw InputError(path.string(),
                     "continues a recording in another folder; only one in the same folder can be read");
  const fs::path before_it = path.parent_path() / name;
  if (std::error_code error; !fs::exists(before_it, error))
    throw InputError(path.string(),
                     "continues " + name.string() + ", which is missing; copy it into the same folder");
  later.push_back(fs::canonical(path));
  if (later.size() > kMost || std::ranges::find(later, fs::canonical(before_it)) != later.end())
    throw InputError(path.string(), "continues too many recordings, or itself");
  Recording whole = read_chain(before_it, std::move(later));
  if (whole.sessions.empty() || whole.description.scan_hash != recording.description.scan_hash ||
      whole.description.labels.size() != recording.description.labels.size())
    throw InputError(
        path.string(),
        "continues " + name.string() +
            ", but that file is of another scan, has other labels, or holds no ticks; restore the original");
  if (const std::uint64_t ticks = recording.sessions.front().start.continues_after; ticks > 0) {
    if (ticks > whole.records.size())
      throw InputError(path.string(), fmt::format("continues after tick {} of {}, which has only {} ticks",
                                                  ticks, name.string(), whole.records.size()));
    keep_first_ticks(whole, ticks);
  }
  if (const auto from = branch_point(recording.description)) put_branch_point(whole.description, *from);
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
  whole.views.insert(whole.views.end(), recording.views.begin(), recording.views.end());
  // The recording that a branch starts from is an attempt of its own.
  const bool is_branch = recording.sessions.front().start.continues_after > 0;
  whole.continues = is_branch ? fs::path() : whole.path;
  whole.path = path;
  whole.pictures = std::move(recording.pictures);
  whole.complete = whole.complete && recording.complete;
  whole.dropped += recording.dropped;
  return whole;
}

}  // namespace

Recording read_recording_chain(const fs::path& path) {
  return read_chain(path, {});
}

bool is_hdf5(const fs::path& path) {
  const Hdf5Lock lock;
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && H5Fis_hdf5(path.c_str()) > 0;
}

namespace {

bool has_same_setup(const RunDescription& a, const RunDescription& b) {
  const auto settings = [](const RunDescription& run) {
    std::vector<RunSetting> those = run.settings;
    // Ignores entries that are not settings: the command line and the resulting number of sample points.
    std::erase_if(those, [](const RunSetting& setting) {
      return setting.key == kCommandLineKey || setting.key == kSamplePointsKey;
    });
    return those;
  };
  return a.algorithm == b.algorithm && a.isovalue == b.isovalue && a.tool == b.tool &&
         settings(a) == settings(b);
}

}  // namespace

std::vector<Recording> split_by_setup(Recording recording) {
  std::vector<std::size_t> first{0};
  const std::vector<RecordedSession>& sessions = recording.sessions;
  for (std::size_t n = 1; n < sessions.size(); ++n) {
    if (sessions[n].first > sessions[first.back()].first &&
        !has_same_setup(sessions[n - 1].start.run, sessions[n].start.run))
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
