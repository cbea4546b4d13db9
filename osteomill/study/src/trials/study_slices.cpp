#include "osteomill/study/study_slices.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <new>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/read_hdf5.h"
#include "osteomill/study/metric_table.h"

namespace osteomill {

namespace fs = std::filesystem;

// Raw content of a slice's file.
struct SliceContent {
  std::vector<std::uint64_t> trials;
  std::vector<double> values;
  std::string not_reached;
  double cpu_s = 0;
};

// Members to copy from the process that reads the file.
static auto members_of(StudyRecord& record) {
  return std::tie(record.study_hash, record.program_hash, record.scans_from, record.trials,
                  record.trials_a_slice, record.bones);
}
static auto members_of(SliceContent& content) {
  return std::tie(content.trials, content.values, content.not_reached, content.cpu_s);
}

namespace {

constexpr const char* kRecordVersion = "osteomill_study_version";
constexpr const char* kSliceVersion = "osteomill_slice_version";
constexpr std::uint64_t kVersion = 2;

void add_text(WordHash& hash, std::string_view text) {
  for (const char c : text) hash.add(static_cast<unsigned char>(c));
  hash.add(text.size());
}

// Throws if writing or flushing to disk fails.
void write_hdf5(const fs::path& path, const std::function<void(hid_t)>& write) {
  write_file_atomically(path, [&](const fs::path& beside) {
    const Hdf5Lock lock;
    const Hdf5Handle access = access_without_locks();
    Hdf5Handle file(H5Fcreate(beside.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
    if (!file.valid()) throw InputError(path.string(), with_reason("cannot be created"));
    write(file.get());
    if (!file.close()) throw InputError(path.string(), with_reason("cannot be written to its end"));
  });
}

// Writes rows of `width` values with a checksum, so that damage is detected.
template <typename Value>
void write_dataset(const fs::path& path, hid_t file, const char* name, const std::vector<Value>& values,
                   hsize_t width = 1) {
  const std::array<hsize_t, 2> dims{values.size() / width, width};
  const int rank = width == 1 ? 1 : 2;
  const Hdf5Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout.get(), rank, dims.data());
  H5Pset_fletcher32(layout.get());
  const Hdf5Handle space(H5Screate_simple(rank, dims.data(), nullptr), H5Sclose);
  const hid_t type = memory_type<Value>();
  const Hdf5Handle dataset(H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, layout.get(), H5P_DEFAULT),
                           H5Dclose);
  if (!dataset.valid() || H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw InputError(path.string(), with_reason(fmt::format("'{}' cannot be written", name)));
}

// Reads a dataset of `rows` rows. Throws if the number of rows differs.
template <typename Value>
std::vector<Value> read_rows(const Hdf5File& file, const char* name, std::size_t rows, hsize_t width = 1) {
  const Hdf5Column column = open_column(file, name, width);
  if (column.rows != rows) file.refuse(fmt::format("'{}' is of another length", name));
  return read_values<Value>(file, column);
}

void require_version(const Hdf5File& file, const char* name) {
  const Attributes read(file.path, file.id());
  if (!read.has(name) || read.get<std::uint64_t>(name) != kVersion)
    file.refuse("is not what a study of this program writes");
}

StudyRecord record_in(const Hdf5File& file) {
  require_version(file, kRecordVersion);
  const Attributes read(file.path, file.id());
  StudyRecord record{read.get<std::uint64_t>("study_hash"),     read.get<std::uint64_t>("program_hash"),
                     read.get<std::string>("scans_from"),       read.get<std::uint64_t>("trials"),
                     read.get<std::uint64_t>("trials_a_slice"), {}};
  if (record.trials == 0 || record.trials_a_slice == 0 || record.trials_a_slice > record.trials)
    file.refuse("has no trials");
  const auto bones = read.get<std::uint64_t>("bones");
  for (std::uint64_t n = 0; n < bones; ++n)
    record.bones.emplace_back(read.get<std::string>(fmt::format("bone_{}", n)),
                              read.get<std::uint64_t>(fmt::format("bone_{}_fingerprint", n)));
  return record;
}

}  // namespace

std::size_t StudyRecord::size_of(std::size_t slice) const {
  return std::min(trials_a_slice, trials - std::min(trials, first_of(slice)));
}

std::uint64_t StudyRecord::hash() const {
  WordHash hash;
  for (const std::uint64_t word :
       {study_hash, program_hash, std::uint64_t{trials}, std::uint64_t{trials_a_slice}})
    hash.add(word);
  for (const auto& [bone, fingerprint] : bones) {
    add_text(hash, bone);
    hash.add(fingerprint);
  }
  return hash.value();
}

std::uint64_t hash_of_file(const fs::path& path) {
  // Reading a pipe would block.
  if (std::error_code error; fs::exists(path, error) && !fs::is_regular_file(path, error))
    throw InputError(path.string(), "is no regular file");
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(path.string(), "cannot be read");
  WordHash hash;
  add_text(hash, bytes);
  return hash.value();
}

void write_study_record(const fs::path& folder, const StudyRecord& record) {
  const fs::path path = folder / "study.h5";
  write_hdf5(path, [&](hid_t file) {
    const Attributes write(path, file);
    write.put(kRecordVersion, kVersion);
    write.put("study_hash", record.study_hash);
    write.put("program_hash", record.program_hash);
    write.put("scans_from", record.scans_from);
    write.put("trials", std::uint64_t{record.trials});
    write.put("trials_a_slice", std::uint64_t{record.trials_a_slice});
    write.put("bones", std::uint64_t{record.bones.size()});
    for (std::size_t n = 0; n < record.bones.size(); ++n) {
      write.put(fmt::format("bone_{}", n), record.bones[n].first);
      write.put(fmt::format("bone_{}_fingerprint", n), record.bones[n].second);
    }
  });
}

std::optional<StudyRecord> read_study_record(const fs::path& folder) {
  const fs::path path = folder / "study.h5";
  if (std::error_code error; !fs::exists(path, error)) return std::nullopt;
  return read_hdf5(path, record_in);
}

fs::path slice_path(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("slice-{}.h5", number);
}

void rethrow_with_trial(const fs::path& file, std::size_t trial) {
  std::string reason = "not enough memory";
  try {
    throw;
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  } catch (const std::exception& error) {
    reason = error.what();
  }
  throw InputError(file.string(), fmt::format("trial {}: {}", trial, reason));
}

Slice run_slice(const StudyFolder& study, std::size_t number, const std::vector<TrialPlan>& trials,
                std::size_t threads, const RunEvents& events) {
  Slice slice{number, {}, 0};
  const std::size_t first = study.record.first_of(number);
  const auto tried = run_trials(trials, "study", threads, events, [&](const TrialPlan& trial) {
    try {
      return run_single_trial(study.test, trial);
    } catch (...) {
      rethrow_with_trial(study.path / "study.toml", first + static_cast<std::size_t>(&trial - trials.data()));
    }
  });
  for (std::size_t n = 0; n < tried.size(); ++n) {
    slice.cpu_s += tried[n].cpu_s;
    if (tried[n].faults) events.warn(fmt::format("trial {}: {}", first + n, *tried[n].faults));
    for (const TrialRow& row : tried[n].rows) {
      slice.rows.push_back(row);
      slice.rows.back().trial = first + n;
    }
  }
  return slice;
}

void write_slice(const StudyFolder& study, const Slice& slice) {
  const fs::path path = slice_path(study.path, slice.number);
  std::vector<std::uint64_t> trials;
  std::vector<double> values;
  std::vector<unsigned char> not_reached;
  for (const TrialRow& row : slice.rows) {
    trials.push_back(row.trial);
    for (const Field<TrialRow>& column : columns_of(study.test)) values.push_back(column.get(row));
    not_reached.insert(not_reached.end(), row.run.not_reached.begin(), row.run.not_reached.end());
    not_reached.push_back('\n');
  }
  write_hdf5(path, [&](hid_t file) {
    const Attributes write(path, file);
    write.put(kSliceVersion, kVersion);
    write.put("made_of", study.record.hash());
    write.put("slice", std::uint64_t{slice.number});
    write.put("cpu_s", slice.cpu_s);
    write.put("columns", csv_names(columns_of(study.test)).substr(1));
    write.put("not_reached_bytes", std::uint64_t{not_reached.size()});
    write_dataset(path, file, "trial", trials);
    write_dataset(path, file, "values", values, columns_of(study.test).size());
    write_dataset(path, file, "not_reached", not_reached);
  });
}

namespace {

// Throws if the file belongs to another slice.
SliceContent content_of(const Hdf5File& file, const StudyFolder& study, std::size_t number) {
  const std::size_t count = study.record.size_of(number) * parts_of(study.test).size();
  require_version(file, kSliceVersion);
  const Attributes read(file.path, file.id());
  if (read.get<std::uint64_t>("made_of") != study.record.hash() || read.get<std::uint64_t>("slice") != number)
    file.refuse("is of another study");
  const auto bytes =
      read_rows<unsigned char>(file, "not_reached", read.get<std::uint64_t>("not_reached_bytes"));
  return {read_rows<std::uint64_t>(file, "trial", count),
          read_rows<double>(file, "values", count, columns_of(study.test).size()),
          {bytes.begin(), bytes.end()},
          read.get<double>("cpu_s")};
}

// Converts a file's content to a slice; returns nothing if its trials are not the slice's.
std::optional<Slice> slice_of(const SliceContent& content, const StudyFolder& study, std::size_t number) {
  const std::vector<Field<TrialRow>>& columns = columns_of(study.test);
  const auto parts = parts_of(study.test);
  std::istringstream lines(content.not_reached);
  Slice slice{number, {}, content.cpu_s};
  for (std::size_t n = 0; n < content.trials.size(); ++n) {
    TrialRow& row = slice.rows.emplace_back(TrialRow{.trial = content.trials[n], .part = n % parts.size()});
    if (row.trial != study.record.first_of(number) + n / parts.size() ||
        !std::getline(lines, row.run.not_reached))
      return std::nullopt;
    row.run.phase = parts[row.part];
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].set(row, content.values[n * columns.size() + c]);
  }
  return slice;
}

}  // namespace

std::optional<Slice> read_slice(const StudyFolder& study, std::size_t number) {
  const fs::path path = slice_path(study.path, number);
  if (is_locked(path)) throw InputError(path.string(), "is locked by another program");
  try {
    const auto content =
        read_hdf5(path, [&](const Hdf5File& file) { return content_of(file, study, number); });
    return slice_of(content, study, number);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

StudyStatus study_status(const StudyFolder& study, std::vector<TrialRow>* rows) {
  StudyStatus status;
  for (std::size_t number = 0; number < study.record.slices(); ++number) {
    if (fs::path path = slice_path(study.path, number); is_locked(path)) {
      status.locked.push_back(std::move(path));
      continue;
    }
    std::optional<Slice> slice = read_slice(study, number);
    if (slice) {
      if (rows != nullptr) std::ranges::move(slice->rows, std::back_inserter(*rows));
      status.done.push_back(number);
      status.trials_done += study.record.size_of(number);
      status.cpu_s += slice->cpu_s;
      continue;
    }
    status.missing.push_back(number);
    std::error_code error;
    if (const fs::path path = slice_path(study.path, number); fs::exists(path, error))
      status.damaged.push_back(path);
  }
  return status;
}

void require_none_locked(const StudyStatus& status) {
  if (!status.locked.empty())
    throw InputError(status.locked.front().string(), "is locked by another program");
}

}  // namespace osteomill
