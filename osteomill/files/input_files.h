#pragma once

#include <filesystem>

namespace osteomill {

/// While one lives, nothing of this program writes over a file that it has read as input: whatever writes by
/// `output_path` (atomic_file.h) refuses it. One at a time; for a command, whose user may name the same file
/// twice.
class KeepInputs {
 public:
  KeepInputs();
  ~KeepInputs();
  KeepInputs(const KeepInputs&) = delete;
  KeepInputs& operator=(const KeepInputs&) = delete;
};

/// To be called by whatever opens a file as input, however it came to it: named by the user, in a folder,
/// behind a header, beside a recording. From any thread.
void note_input(const std::filesystem::path& path);

/// Whether this is a file that was noted, by device and inode. Never without KeepInputs. From any thread.
bool is_input(const std::filesystem::path& path);

}  // namespace osteomill
