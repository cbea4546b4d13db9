#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/recording/run_description.h"
#include "osteomill/recording/view_sample.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/tick_record.h"
#include "osteomill/volume/density_block.h"

namespace osteomill {

/// The state that a session begins from, if that is not a scan as it was read. With the inputs of its ticks
/// it is all that it takes to run them again.
struct SessionStart {
  RunDescription run;
  SessionHandover handover;
  double removed_mm3 = 0;
  /// Every brick in which the bone may differ from the scan, as it is at the beginning.
  std::vector<DensityBlock> bricks;
  /// If not empty, the session began in the recording of this name in the same folder, and this one goes on
  /// after the first `continues_after` of its ticks (0: after all). The other fields mean nothing then.
  std::string continues_from = {};
  std::uint64_t continues_after = 0;
  /// By how much densities fell with pieces that were removed and not milled, times the voxels' volume, mm^3,
  /// summed over each label's voxels, by its place; empty if there are none.
  std::vector<double> piece_drops = {};
};

/// A picture that belongs to a recording, as the bytes of a PNG file.
struct RunPicture {
  std::string name;
  std::vector<unsigned char> png;
};

/// The name of the picture of the bone before the run; reports lay the pictures side by side.
inline constexpr std::string_view kPictureBefore = "before";
/// The name of the picture of the bone after the run.
inline constexpr std::string_view kPictureAfter = "after";
/// The name of the picture after the run, seen along the entry: there if the other view does not show what
/// was removed.
inline constexpr std::string_view kPictureAlong = "along";

/// The key of the further setting of a run that has no pictures because OpenGL could not be had.
inline constexpr std::string_view kPicturesKey = "pictures";

/// A session in a recording: what it began from, and its first tick as an index of the records.
struct RecordedSession {
  std::size_t first = 0;
  SessionStart start;
};

/// The hash of the bone after a tick (TickRecord::bone_hash).
struct BoneHash {
  std::size_t record = 0;
  std::uint64_t hash = 0;
  friend bool operator==(const BoneHash&, const BoneHash&) = default;
};

/// One run, a record a tick.
struct Recording {
  /// The file it was read from; errors name it.
  std::filesystem::path path;
  /// The file of the recording that it continues from its end, if that was read with it
  /// (read_recording_chain).
  std::filesystem::path continues;
  /// The description of the first session.
  RunDescription description;
  /// The sessions in turn, from the first record on. Read records carry the session's place here as
  /// TickRecord::session.
  std::vector<RecordedSession> sessions;
  /// The hashes of every hundredth record, and of the last one.
  std::vector<BoneHash> bone_hashes;
  std::vector<TickRecord> records;
  /// The views that a trainee had, by time; none if there was no window.
  std::vector<ViewSample> views;
  /// The pictures, sorted by name.
  std::vector<RunPicture> pictures;
  /// False if the program ended before it closed the recording; up to the last second is missing.
  bool complete = true;
  /// Ticks that found the recorder's queue full and are not among `records`.
  std::uint64_t dropped = 0;
};

/// Splits a recording into one for each stretch in which algorithm, tool and settings stayed as they were (a
/// cut taken back ends none), to be measured one by one. If there are several, their phases are their
/// numbers.
std::vector<Recording> split_by_setup(Recording recording);

/// Reads a recording that a Recorder wrote, or the unfinished one that a killed program left (`complete` is
/// then false). Throws InputError, naming the file, if it is not HDF5, is no recording of a version that is
/// known, is cut short or damaged, or its columns are missing, of another type or of unequal lengths; only in
/// an unfinished recording are columns of unequal lengths cut to the shortest. A finished recording is held
/// against its checksum before HDF5 reads it; one without (unfinished, or rewritten by another program) is
/// read as it is. Sizes are held against the file's before memory is taken.
Recording read_recording(const std::filesystem::path& path);

/// Reads a recording that may go on from another one in its folder (SessionStart::continues_from), and that
/// from a third: all as one, described as the first, except for where the last goes on from (branch_point).
/// Throws as read_recording.
Recording read_recording_chain(const std::filesystem::path& path);

/// Reads what write_start wrote. The file is no input of the program's (input_files.h): it may be written
/// over.
SessionStart read_start(const std::filesystem::path& path);

/// Returns whether a file is HDF5, as recordings are.
bool is_hdf5(const std::filesystem::path& path);

}  // namespace osteomill
