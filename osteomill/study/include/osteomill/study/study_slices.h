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

/// Which study a folder is of: the content of its file study.h5. The study's trials are run in slices, trials
/// that follow each other, and a slice is done when its file lies in the folder.
struct StudyRecord {
  /// Hashes of the study's file and of the program, as bytes.
  std::uint64_t study_hash = 0;
  std::uint64_t program_hash = 0;
  /// From where the study names its scans.
  std::string scans_from;
  std::size_t trials = 0;
  std::size_t trials_a_slice = 1;
  /// fingerprint_of each bone that is tried, by what is set of it.
  std::vector<std::pair<std::string, std::uint64_t>> bones;

  std::size_t slices() const { return (trials + trials_a_slice - 1) / trials_a_slice; }
  std::size_t first_of(std::size_t slice) const { return slice * trials_a_slice; }
  /// Returns the number of trials in this slice.
  std::size_t size_of(std::size_t slice) const;
  /// Returns a hash of everything above.
  std::uint64_t hash() const;
};

/// Returns a hash of a file's bytes. Throws InputError if it cannot be read.
std::uint64_t hash_of_file(const std::filesystem::path& path);

/// Writes study.h5 into `folder`, whole or not at all. Throws InputError if it cannot be written.
void write_study_record(const std::filesystem::path& folder, const StudyRecord& record);
/// Returns what study.h5 in `folder` holds; nothing if there is no such file. Throws InputError if it is not
/// what `write_study_record` writes.
std::optional<StudyRecord> read_study_record(const std::filesystem::path& folder);

/// A study that was begun, by its folder.
struct StudyFolder {
  std::filesystem::path path;
  StudyRecord record;
  StudyTest test = StudyTest::milling;
};

/// Trials that follow each other, and what came of them (run_slice()).
struct Slice {
  std::size_t number = 0;
  /// The rows, by trial and then by part of the test.
  std::vector<TrialRow> rows;
  /// The CPU time on all threads.
  double cpu_s = 0;
};

/// Throws what is being handled, in a catch clause, as an InputError that names the study's file and the
/// trial; nothing that was said of them is lost.
[[noreturn]] void throw_of_trial(const std::filesystem::path& file, std::size_t trial);

/// Returns the path of a slice's file: FOLDER/slice-12.h5.
std::filesystem::path slice_path(const std::filesystem::path& folder, std::size_t number);

/// Runs the trials of a slice, side by side on `threads` threads; except for times, the rows are the same for
/// any number of threads. Throws InputError, naming the study's file and the trial, if one cannot be run.
Slice run_slice(const StudyFolder& study, std::size_t number, const std::vector<TrialPlan>& trials,
                std::size_t threads, const RunEvents& events);

/// Writes a slice's file, whole or not at all. Throws InputError if it cannot be written.
void write_slice(const StudyFolder& study, const Slice& slice);

/// Returns the slice of this number; nothing if there is no such file, or it is cut short, damaged, or of
/// another study, so that the slice is to be run (again). Throws InputError if another program holds a lock
/// on it.
std::optional<Slice> read_slice(const StudyFolder& study, std::size_t number);

/// The progress of a study, by the files of its folder.
struct StudyStatus {
  /// The numbers of the slices that are done, and of those that are missing.
  std::vector<std::size_t> done;
  std::vector<std::size_t> missing;
  std::size_t trials_done = 0;
  double cpu_s = 0;
  /// Files that are there and cannot be used.
  std::vector<std::filesystem::path> damaged;
  /// Files on which another program holds a lock: neither done nor missing, as far as anybody can tell.
  std::vector<std::filesystem::path> locked;
};
/// Throws InputError if a file is locked, and what is done therefore not known.
void require_none_locked(const StudyStatus& status);
/// Returns the progress of a study. Puts the rows that are done behind `rows`, if that is not null.
StudyStatus study_status(const StudyFolder& study, std::vector<TrialRow>* rows = nullptr);

}  // namespace osteomill
