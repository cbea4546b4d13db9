#pragma once

#include <filesystem>

#include "osteomill/recording/recording.h"

namespace osteomill {

/// Reads a recording that a Recorder wrote, or the unfinished one that a killed program left (`complete` is
/// then false). Throws InputError, naming the file, where it is not HDF5, is no recording of a version that
/// is known, is cut short or damaged, or its columns are missing, of another type or of unequal lengths; only
/// in an unfinished recording are columns of unequal lengths cut to the shortest. A finished recording is
/// held against its checksum before HDF5 reads it; one without (unfinished, or rewritten by another program)
/// is read as it is. Sizes are held against the file's before memory is taken.
Recording read_recording(const std::filesystem::path& path);

/// The same where it may go on from another recording in its folder (SessionStart::goes_on_from): both as
/// one, described as the first.
Recording read_with_what_came_before(const std::filesystem::path& path);

/// Whether a file is HDF5, as recordings are.
bool is_hdf5(const std::filesystem::path& path);

}  // namespace osteomill
