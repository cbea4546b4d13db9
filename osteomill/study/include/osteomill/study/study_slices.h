#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/study/run_trials.h"
#include "osteomill/study/study_design.h"

namespace osteomill {

/// Identity of the study in a folder: the content of its file study.h5. Trials are run in slices of
/// consecutive trials; a slice is done when its file exists in the folder.
struct StudyRecord {
  /// Hashes of the bytes of the study's file and of the program.
  std::uint64_t study_hash = 0;
  std::uint64_t program_hash = 0;
  /// Folder that the study's scan paths are relative to.
  std::string scans_from;
  std::size_t trials = 0;
  std::size_t trials_a_slice = 1;
  /// fingerprint_of each bone that is tried, keyed by its settings.
  std::vector<std::pair<std::string, std::uint64_t>> bones;

  std::size_t slices() const { return (trials + trials_a_slice - 1) / trials_a_slice; }
  std::size_t first_of(std::size_t slice) const { return slice * trials_a_slice; }
  /// Returns the number of trials in this slice.
  std::size_t size_of(std::size_t slice) const;
  /// Returns a hash of everything above.
  std::uint64_t hash() const;
};

/// Hashes the bytes of a file. Throws InputError if it cannot be read.
std::uint64_t hash_of_file(const std::filesystem::path& path);

/// Writes study.h5 into `folder` atomically. Throws InputError if it cannot be written.
void write_study_record(const std::filesystem::path& folder, const StudyRecord& record);
/// Reads study.h5 in `folder`; returns nothing if there is no such file. Throws InputError if the file was
/// not written by `write_study_record`.
std::optional<StudyRecord> read_study_record(const std::filesystem::path& folder);

/// A study that was begun, identified by its folder.
struct StudyFolder {
  std::filesystem::path path;
  StudyRecord record;
  StudyTest test = StudyTest::milling;
};

/// Consecutive trials and their results (run_slice()).
struct Slice {
  std::size_t number = 0;
  /// Rows, ordered by trial and then by part of the test.
  std::vector<TrialRow> rows;
  /// CPU time of all threads.
  double cpu_s = 0;
};

/// Rethrows the exception being handled, in a catch clause, as an InputError that names the study's file and
/// the trial and keeps the original message.
[[noreturn]] void rethrow_with_trial(const std::filesystem::path& file, std::size_t trial);

/// Returns the path of a slice's file: FOLDER/slice-12.h5.
std::filesystem::path slice_path(const std::filesystem::path& folder, std::size_t number);

/// Runs the trials of a slice on `threads` threads; except for times, the rows do not depend on the number of
/// threads. Throws InputError, naming the study's file and the trial, if one cannot be run.
Slice run_slice(const StudyFolder& study, std::size_t number, const std::vector<TrialPlan>& trials,
                std::size_t threads, const RunEvents& events);

/// Writes a slice's file atomically. Throws InputError if it cannot be written.
void write_slice(const StudyFolder& study, const Slice& slice);

/// Reads the slice of this number. Returns nothing if its file is missing, truncated, damaged or belongs to
/// another study, so that the slice must be run (again). Throws InputError if another program has locked the
/// file.
std::optional<Slice> read_slice(const StudyFolder& study, std::size_t number);

/// Progress of a study, from the files in its folder.
struct StudyStatus {
  /// Numbers of the slices that are done and of those that are missing.
  std::vector<std::size_t> done;
  std::vector<std::size_t> missing;
  std::size_t trials_done = 0;
  double cpu_s = 0;
  /// Files that exist but cannot be used.
  std::vector<std::filesystem::path> damaged;
  /// Files locked by another program: neither done nor missing as far as can be determined.
  std::vector<std::filesystem::path> locked;
};
/// Throws InputError if a file is locked, because the progress is then unknown.
void require_none_locked(const StudyStatus& status);
/// Returns the progress of a study. Appends the finished rows to `rows` if it is not null.
StudyStatus study_status(const StudyFolder& study, std::vector<TrialRow>* rows = nullptr);

}  // namespace osteomill
