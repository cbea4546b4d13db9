#include "recording_file.h"

#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <mutex>
#include <set>
#include <string_view>
#include <tuple>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/view_sample.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Chunk size for sparse data: a partial chunk is rewritten with every flush.
constexpr hsize_t kSmallChunkRows = 64;
// Higher levels take longer and save next to nothing, because the low bits of poses and forces are noise.
constexpr unsigned kDeflateLevel = 1;
// Flushes between two calls of evict_flushed_metadata(): some five seconds.
constexpr std::uint64_t kFlushesPerEviction = 10;
// Space for HDF5's metadata until the next flush, bytes: chunk addresses and the names in a session.
constexpr std::uint64_t kRoomForMetadata = 256 * 1024;

constexpr const char* kConventions =
    "Units are in each dataset's attribute 'unit' (mm, N, N mm, s, kg, rad); its attribute 'meaning' says "
    "what "
    "it is. Frame W: the scan's patient frame, DICOM LPS axes, mm. Frame T: origin at the burr's centre, +z "
    "along the shaft to the hand. X_WT is T's pose in W; X_WD the device's, as a tool pose. Quaternions are "
    "w, x, y, z. Wrenches act on the hand, in W's axes, about the burr's centre. Voxel (i, j, k) lies at "
    "origin_mm + i spacing_mm[0] axis_i + j spacing_mm[1] axis_j + k spacing_mm[2] axis_k. osteomill: "
    "docs/recordings.md.";

// "0 none, 1 force clamped, ..."
std::string codes_of(const FieldDescription& column) {
  std::string codes;
  for (std::size_t code = 0; code < column.choices.size(); ++code)
    codes += fmt::format("{}{} {}", code == 0 ? "" : ", ", code, column.choices[code]);
  return codes;
}

hid_t file_type(const NumberRange& range) {
  if (!range.whole) return H5T_IEEE_F64LE;
  return range.max <= std::numeric_limits<std::uint8_t>::max() ? H5T_STD_U8LE : H5T_STD_I32LE;
}

// Disables HDF5's metadata cache eviction. Otherwise HDF5 also writes part of the metadata between flushes,
// whenever the cache is full, and a program killed then leaves a file that cannot be opened.
// `evict_flushed_metadata` frees the cache instead.
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

constexpr std::string_view kStart = "osteomill recording; HDF5 follows after 512 bytes, their crc32: ";

// Checksum from the stream's position to the end of the file.
unsigned long crc32_of_rest(std::istream& in) {
  std::vector<char> buffer(1 << 20);
  unsigned long crc = ::crc32(0, nullptr, 0);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), in.gcount() > 0) {
    crc = ::crc32(crc, reinterpret_cast<const Bytef*>(buffer.data()), static_cast<uInt>(in.gcount()));
  }
  return crc;
}

// Guards own_checksums, the checksums of recordings finished by this process.
std::mutex own_mutex;
std::set<unsigned long> own_checksums;

std::string seal_line(unsigned long crc) {
  return fmt::format("{}{:08x}\n", kStart, crc);
}

}  // namespace

RecordingFile::RecordingFile(const fs::path& path, const RunDescription& description) : path_(path) {
  const Hdf5Lock lock;
  const Hdf5Handle layout(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(layout.get(), kUserBlockBytes);
  // Never reuses freed space: until the next flush, the file on disk refers to the old location of rewritten
  // data.
  H5Pset_file_space_strategy(layout.get(), H5F_FSPACE_STRATEGY_NONE, false, 1);
  const Hdf5Handle access = access_without_locks();
  H5Pset_evict_on_close(access.get(), true);
  file_ = Hdf5Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, layout.get(), access.get()), H5Fclose);
  try {
    require(file_.valid(), "cannot be created");
    lay_out(description);
  } catch (...) {
    // Close here, because members are destroyed after the lock is released.
    close();
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
}

void RecordingFile::lay_out(const RunDescription& description) {
  reserve(0);
  const Attributes write(path_, file_.get());
  write.put("osteomill_recording_version", kRecordingVersion);
  write.put("complete", std::uint64_t{0});
  write.put("dropped_records", std::uint64_t{0});
  write.put("conventions", kConventions);
  write_description(path_, file_.get(), description);
  labels_ = description.labels;
  create_columns();
  create_group(file_.get(), "pictures");
  create_group(file_.get(), "sessions");
  require(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be written");
  require(keep_metadata_until_flush(file_.get()), "cannot be set up for writing");
}

RecordingFile::~RecordingFile() {
  const Hdf5Lock lock;
  close();
}

bool RecordingFile::close() {
  bool closed = true;
  for (std::vector<Column>* columns : {&columns_, &cut_columns_, &hash_columns_, &view_columns_})
    for (Column& column : *columns) closed = column.dataset.close() && closed;
  if (!file_.valid()) return closed;
  closed = H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0 && closed;
  try {
    closed = ::ftruncate(descriptor(), static_cast<::off_t>(end())) == 0 && closed;
  } catch (const InputError&) {
    closed = false;
  }
  return file_.close() && closed;
}

int RecordingFile::descriptor() const {
  void* descriptor = nullptr;
  require(H5Fget_vfd_handle(file_.get(), H5P_DEFAULT, &descriptor) >= 0, "cannot be set up for writing");
  return *static_cast<const int*>(descriptor);
}

std::uint64_t RecordingFile::end() const {
  haddr_t end = 0;
  require(H5Fget_eoa(file_.get(), &end) >= 0, "cannot be set up for writing");
  return end;
}

// Reserves disk space before writing, because HDF5 leaves a corrupt file if a write fails half-way.
void RecordingFile::reserve(std::uint64_t bytes) {
  const std::uint64_t wanted = end() + bytes + kRoomForMetadata;
  if (wanted <= reserved_) return;
  int error = EINTR;
  while (error == EINTR) {
    error = ::posix_fallocate(descriptor(), static_cast<::off_t>(reserved_),
                              static_cast<::off_t>(wanted - reserved_));
  }
  errno = error;
  require(error == 0, "cannot be written");
  reserved_ = wanted;
}

Hdf5Handle RecordingFile::create_group(hid_t in, const std::string& name) const {
  Hdf5Handle group(H5Gcreate2(in, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  require(group.valid(), "cannot be written");
  return group;
}

template <typename Struct>
std::vector<RecordingFile::Column> RecordingFile::create_columns_of(hid_t group, hsize_t chunk_rows) const {
  std::vector<Column> columns;
  for (const Field<Struct>& column : fields_of<Struct>()) {
    columns.push_back(create_column(group, column.name.c_str(), file_type(column.range), column.unit.c_str(),
                                    1, chunk_rows));
    const Attributes write(path_, columns.back().dataset.get());
    write.put("meaning", column.doc);
    if (!column.choices.empty()) write.put("codes", codes_of(column));
  }
  return columns;
}

void RecordingFile::create_columns() {
  columns_ = create_columns_of<TickRecord>(create_group(file_.get(), "columns").get(), kChunkRows);
  const Hdf5Handle hashes = create_group(file_.get(), "bone_hash");
  for (const char* name : {"row", "hash"})
    hash_columns_.push_back(create_column(hashes.get(), name, H5T_STD_U64LE, "", 1, kSmallChunkRows));
  if (labels_.empty()) return;
  const Hdf5Handle labels(H5Gopen2(file_.get(), "labels", H5P_DEFAULT), H5Gclose);
  cut_columns_.push_back(create_column(labels.get(), "row", H5T_STD_U64LE, "", 1, kSmallChunkRows));
  cut_columns_.push_back(create_column(labels.get(), "label", H5T_STD_I32LE, "", 1, kSmallChunkRows));
  cut_columns_.push_back(
      create_column(labels.get(), "removed_mm3", H5T_IEEE_F64LE, "mm^3", 1, kSmallChunkRows));
}

RecordingFile::Column RecordingFile::create_column(hid_t group, const char* name, hid_t type,
                                                   const char* unit, hsize_t width,
                                                   hsize_t chunk_rows) const {
  const int rank = width == 1 ? 1 : 2;
  const std::array<hsize_t, 2> none{0, width};
  const std::array<hsize_t, 2> unlimited{H5S_UNLIMITED, width};
  const std::array<hsize_t, 2> chunk{chunk_rows, width};
  const Hdf5Handle space(H5Screate_simple(rank, none.data(), unlimited.data()), H5Sclose);
  const Hdf5Handle pieces(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(pieces.get(), rank, chunk.data());
  H5Pset_shuffle(pieces.get());
  H5Pset_deflate(pieces.get(), kDeflateLevel);
  const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  // Caches only the chunk being written.
  H5Pset_chunk_cache(access.get(), 3, 2 * chunk_rows * width * sizeof(double), 1);
  Column column{
      Hdf5Handle(H5Dcreate2(group, name, type, space.get(), H5P_DEFAULT, pieces.get(), access.get()),
                 H5Dclose),
      width};
  require(column.dataset.valid(), "a column cannot be created");
  Attributes(path_, column.dataset.get()).put("unit", unit);
  return column;
}

void RecordingFile::require(bool ok, const char* what) const {
  if (!ok) throw InputError(path_.string(), with_reason(what));
}

void RecordingFile::begin_session(const SessionStart& start, std::uint64_t row) {
  const Hdf5Lock lock;
  reserve(start.bricks.size() * sizeof(DensityBlock));
  const std::string place = "sessions/" + std::to_string(sessions_);
  const Hdf5Handle group = create_group(file_.get(), place);
  const Attributes write(path_, group.get());
  write.put("row", row);
  write.put("goes_on_from", start.continues_from);
  if (start.continues_after > 0) write.put("goes_on_after", start.continues_after);
  write.put("removed_mm3", start.removed_mm3);
  write.put("force_N", start.handover.sent.force_N);
  write.put("torque_Nmm", start.handover.sent.torque_Nmm);
  write.put("held_back", std::uint64_t{start.handover.held_back});
  write.put("spindle_rpm", start.handover.spindle_rpm);
  if (const auto& X_WT = start.handover.X_WT) {
    const Quat& q = X_WT->orientation;
    write.put("tool_mm", X_WT->position_mm);
    write.put_reals("tool_wxyz", std::array{q.w(), q.x(), q.y(), q.z()});
  }
  if (!start.piece_drops.empty()) write.put_reals("piece_drops", start.piece_drops);
  if (!start.bricks.empty()) write_bricks(group.get(), start.bricks);
  if (sessions_ > 0) {
    // Labels are stored once, for the whole recording.
    RunDescription run = start.run;
    run.labels.clear();
    write_description(path_, group.get(), run);
  }
  ++sessions_;
}

void RecordingFile::write_bricks(hid_t session, std::span<const DensityBlock> bricks) const {
  std::vector<std::int32_t> first;
  std::vector<float> densities;
  constexpr std::size_t kVoxels = std::tuple_size_v<decltype(DensityBlock::densities)>;
  first.reserve(3 * bricks.size());
  densities.reserve(kVoxels * bricks.size());
  for (const DensityBlock& brick : bricks) {
    for (const int n : {brick.first.i, brick.first.j, brick.first.k}) first.push_back(n);
    densities.insert(densities.end(), brick.densities.begin(), brick.densities.end());
  }
  constexpr hsize_t kBricksOfChunk = 32;
  Column first_column = create_column(session, "brick_first", H5T_STD_I32LE, "voxels", 3, kBricksOfChunk);
  append_to<std::int32_t>(first_column, first);
  Column density_column =
      create_column(session, "brick_densities", H5T_IEEE_F32LE, "", kVoxels, kBricksOfChunk);
  append_to<float>(density_column, densities);
}

void RecordingFile::append(std::span<const TickRecord> records) {
  if (records.empty()) return;
  const Hdf5Lock lock;
  // Upper bound: whole chunks per column, plus one begun and one rewritten; columns of cuts have at most a
  // few values per record.
  reserve((records.size() + 2 * kChunkRows) *
          (columns_.size() + 2 + 3 * std::tuple_size_v<LabelCuts>)*sizeof(double));
  append_fields(columns_, records);
  if (!labels_.empty()) append_cuts(records);
  append_hashes(records);
  rows_ += records.size();
}

void RecordingFile::append_views(std::span<const ViewSample> views) {
  if (views.empty()) return;
  const Hdf5Lock lock;
  reserve((views.size() + 2 * kSmallChunkRows) * fields_of<ViewSample>().size() * sizeof(double));
  if (view_columns_.empty())
    view_columns_ = create_columns_of<ViewSample>(create_group(file_.get(), "view").get(), kSmallChunkRows);
  append_fields(view_columns_, views);
}

template <typename Struct>
void RecordingFile::append_fields(std::vector<Column>& columns, std::span<const Struct> rows) {
  values_.resize(rows.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t row = 0; row < rows.size(); ++row) values_[row] = fields_of<Struct>()[c].get(rows[row]);
    append_to<double>(columns[c], values_);
  }
}

void RecordingFile::append_cuts(std::span<const TickRecord> records) {
  const auto append = [&](std::size_t column, const auto& value) {
    values_.clear();
    for (std::size_t n = 0; n < records.size(); ++n) {
      for (const LabelCut& cut : records[n].label_cuts) {
        if (cut.label != 0 && cut.label <= labels_.size()) values_.push_back(value(n, cut));
      }
    }
    append_to<double>(cut_columns_[column], values_);
  };
  append(0, [&](std::size_t n, const LabelCut&) { return static_cast<double>(rows_ + n); });
  append(1, [&](std::size_t, const LabelCut& cut) {
    return static_cast<double>(labels_[cut.label - 1u].value);
  });
  append(2, [](std::size_t, const LabelCut& cut) { return cut.removed_mm3; });
}

void RecordingFile::append_hashes(std::span<const TickRecord> records) {
  for (std::size_t n = 0; n < records.size(); ++n) {
    last_ = {rows_ + n, records[n].bone_hash};
    if ((last_.record + 1) % kHashRows == 0) append_hash(last_);
  }
}

void RecordingFile::append_hash(const BoneHash& hash) {
  const std::uint64_t row = hash.record;
  append_to<std::uint64_t>(hash_columns_[0], {&row, 1});
  append_to<std::uint64_t>(hash_columns_[1], {&hash.hash, 1});
}

// Appends whole rows.
template <typename Value>
void RecordingFile::append_to(Column& column, std::span<const Value> values) const {
  if (values.empty()) return;
  const int rank = column.width == 1 ? 1 : 2;
  const std::array<hsize_t, 2> count{values.size() / column.width, column.width};
  const std::array<hsize_t, 2> from{column.rows, 0};
  const std::array<hsize_t, 2> all{column.rows + count[0], column.width};
  const hid_t dataset = column.dataset.get();
  const Hdf5Handle memory(H5Screate_simple(rank, count.data(), nullptr), H5Sclose);
  bool ok = H5Dset_extent(dataset, all.data()) >= 0;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  ok = ok &&
       H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr) >= 0;
  ok = ok &&
       H5Dwrite(dataset, memory_type<Value>(), memory.get(), space.get(), H5P_DEFAULT, values.data()) >= 0;
  require(ok, "cannot be written");
  column.rows = all[0];
}

void RecordingFile::flush(std::uint64_t dropped) {
  const Hdf5Lock lock;
  Attributes(path_, file_.get()).replace("dropped_records", dropped);
  require(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, "cannot be written");
  if (++flushes_ % kFlushesPerEviction == 0) evict_flushed_metadata();
}

// Frees HDF5's index of chunk addresses, which grows by 100 MB per hour, by reopening each dataset
// (H5Pset_evict_on_close).
void RecordingFile::evict_flushed_metadata() {
  for (std::vector<Column>* columns : {&columns_, &cut_columns_, &hash_columns_, &view_columns_}) {
    for (Column& column : *columns) {
      const Hdf5Handle access(H5Dget_access_plist(column.dataset.get()), H5Pclose);
      const ssize_t length = H5Iget_name(column.dataset.get(), nullptr, 0);
      require(length > 0, "a column has lost its name");
      std::string name(static_cast<std::size_t>(length), '\0');
      H5Iget_name(column.dataset.get(), name.data(), name.size() + 1);
      column.dataset.close();
      column.dataset = Hdf5Handle(H5Dopen2(file_.get(), name.c_str(), access.get()), H5Dclose);
      require(column.dataset.valid(), "a column cannot be opened again");
    }
  }
}

void RecordingFile::add_picture(const std::string& name, std::span<const unsigned char> png) {
  const Hdf5Lock lock;
  const hsize_t size = png.size();
  reserve(size);
  const Hdf5Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const std::string place = "pictures/" + name;
  const Hdf5Handle dataset(H5Dcreate2(file_.get(), place.c_str(), H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                                      H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose);
  require(dataset.valid() &&
              H5Dwrite(dataset.get(), H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, png.data()) >= 0,
          "a picture cannot be written");
}

void RecordingFile::add_setting(const RunSetting& setting) {
  const Hdf5Lock lock;
  osteomill::add_setting(path_, file_.get(), setting);
}

void RecordingFile::finish(std::uint64_t dropped) {
  const Hdf5Lock lock;
  if (rows_ > 0 && rows_ % kHashRows != 0) append_hash(last_);
  reserve(0);
  const Attributes write(path_, file_.get());
  write.replace("dropped_records", dropped);
  write.replace("complete", 1);
  require(close(), "cannot be written completely");
  write_checksum(path_);
}

void write_checksum(const fs::path& path) {
  errno = 0;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(kUserBlockBytes);
  const unsigned long crc = crc32_of_rest(file);
  file.clear();
  file.seekp(0);
  file << seal_line(crc);
  file.close();
  if (!file) throw InputError(path.string(), with_reason("cannot be written completely"));
  const std::lock_guard lock(own_mutex);
  own_checksums.insert(crc);
}

Checksum check_checksum(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string(), "cannot be read");
  std::string block(kUserBlockBytes, '\0');
  if (!in.read(block.data(), kUserBlockBytes) || !block.starts_with(kStart)) return Checksum::none;
  const unsigned long crc = crc32_of_rest(in);
  if (!block.starts_with(seal_line(crc))) return Checksum::broken;
  const std::lock_guard lock(own_mutex);
  return own_checksums.contains(crc) ? Checksum::our_own : Checksum::intact;
}

}  // namespace osteomill
