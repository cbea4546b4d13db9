#pragma once

#include <filesystem>

namespace osteomill {

/// While one lives, this program does not write over a file that it has read as input: `output_path`
/// (atomic_file.h) refuses it. Meant for commands, whose user may name the same file as input and output.
/// Only one may live at a time.
class KeepInputs {
 public:
  KeepInputs();
  ~KeepInputs();
  KeepInputs(const KeepInputs&) = delete;
  KeepInputs& operator=(const KeepInputs&) = delete;
};

/// To be called by whatever opens a file as input, whether the user named it or it was found in a folder,
/// behind a header or beside a recording. From any thread.
void note_input(const std::filesystem::path& path);

/// Whether this file was noted, compared by device and inode. Always false where no KeepInputs lives. From
/// any thread.
bool is_input(const std::filesystem::path& path);

}  // namespace osteomill
