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

/// Initial state of a session, if that is not the untouched scan. Together with the recorded inputs of its
/// ticks it suffices for a replay.
struct SessionStart {
  RunDescription run;
  SessionHandover handover;
  double removed_mm3 = 0;
  /// Every brick in which the bone may differ from the scan, in its initial state.
  std::vector<DensityBlock> bricks;
  /// If not empty, the name of a recording in the same folder in which the session began; this one continues
  /// it after its first `continues_after` ticks (0: after all). The other fields are then ignored.
  std::string continues_from = {};
  std::uint64_t continues_after = 0;
  /// Per label index, for pieces removed rather than milled: the sum of the density drops over the label's
  /// voxels, times the voxel volume in mm^3. Empty if there are none.
  std::vector<double> piece_drops = {};
};

/// Picture of a recording, as the bytes of a PNG file.
struct RunPicture {
  std::string name;
  std::vector<unsigned char> png;
};

/// Name of the picture of the bone before the run; reports show the pictures side by side.
inline constexpr std::string_view kPictureBefore = "before";
/// Name of the picture of the bone after the run.
inline constexpr std::string_view kPictureAfter = "after";
/// Name of the picture after the run as seen along the entry; present only if the other view does not show
/// the removed bone.
inline constexpr std::string_view kPictureAlong = "along";

/// Key of a further setting, present if the run has no pictures because OpenGL is not available.
inline constexpr std::string_view kPicturesKey = "pictures";

/// Session of a recording: index of its first record, and its initial state.
struct RecordedSession {
  std::size_t first = 0;
  SessionStart start;
};

/// Hash of the bone after a tick (TickRecord::bone_hash).
struct BoneHash {
  std::size_t record = 0;
  std::uint64_t hash = 0;
  friend bool operator==(const BoneHash&, const BoneHash&) = default;
};

/// Recording of one run, one record per tick.
struct Recording {
  /// File it was read from; named in error messages.
  std::filesystem::path path;
  /// File of the recording whose end it continues, if that was read along with it (read_recording_chain).
  std::filesystem::path continues;
  /// Description of the first session.
  RunDescription description;
  /// Sessions in order, starting at the first record. TickRecord::session of the records read is an index
  /// into them.
  std::vector<RecordedSession> sessions;
  /// Bone hashes of every hundredth record and of the last one.
  std::vector<BoneHash> bone_hashes;
  std::vector<TickRecord> records;
  /// Views of the trainee in order of time; empty if there was no window.
  std::vector<ViewSample> views;
  /// Pictures, sorted by name.
  std::vector<RunPicture> pictures;
  /// False if the program ended before closing the recording; up to the last second is then missing.
  bool complete = true;
  /// Number of ticks lost because the recorder's queue was full.
  std::uint64_t dropped = 0;
};

/// Splits a recording wherever algorithm, tool or settings change, so that each part can be measured on its
/// own. An undone cut does not split. If there are several parts, their phases are "part 1", "part 2" and so
/// on.
std::vector<Recording> split_by_setup(Recording recording);

/// Reads a recording that a Recorder wrote, or an unfinished one of a killed program (`complete` is then
/// false). Throws InputError, naming the file, if it is not a recording of a supported version, is truncated
/// or damaged, or has columns that are missing, of another type, or of unequal lengths (in an unfinished
/// recording, columns are cut to the shortest instead). The checksum of a finished recording is verified
/// before HDF5 reads it; files without one (unfinished, or rewritten by another program) are read without
/// this check. Sizes are checked against the file size before memory is allocated.
Recording read_recording(const std::filesystem::path& path);

/// Like read_recording, but also reads the recordings in its folder that it continues
/// (SessionStart::continues_from), directly or through others, and joins them into one. The description is
/// the first one's, except for the branch point of the last (branch_point). Throws as read_recording, and if
/// one of them is missing or does not fit.
Recording read_recording_chain(const std::filesystem::path& path);

/// Reads a file of write_start. Does not register it as an input (input_files.h), so that it may be
/// overwritten.
SessionStart read_start(const std::filesystem::path& path);

/// Returns whether a file is HDF5, as recordings are.
bool is_hdf5(const std::filesystem::path& path);

}  // namespace osteomill
