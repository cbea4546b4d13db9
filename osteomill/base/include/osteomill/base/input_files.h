#pragma once

#include <filesystem>

namespace osteomill {

/// While one lives, this program does not write over a file that it has read as input: `output_path`
/// (atomic_file.h) refuses it. Meant for commands, whose user may name the same file as input and output.
/// Only one may live at a time.
class InputProtection {
 public:
  InputProtection();
  ~InputProtection();
  InputProtection(const InputProtection&) = delete;
  InputProtection& operator=(const InputProtection&) = delete;
};

/// Notes a file that is read as input. All code that opens one calls this, whether the user named the file or
/// it was found in a folder, behind a header or beside a recording. From any thread.
void note_input(const std::filesystem::path& path);

/// Returns whether this file was noted, compared by device and inode; always false while no InputProtection
/// lives. From any thread.
bool is_input(const std::filesystem::path& path);

}  // namespace osteomill
