#pragma once

#include <filesystem>

namespace osteomill {

/// While an object of this class exists, `output_path` (atomic_file.h) refuses to overwrite a file that this
/// program has read as input. Meant for commands, whose user may name the same file as input and output. Only
/// one may exist at a time.
class InputProtection {
 public:
  InputProtection();
  ~InputProtection();
  InputProtection(const InputProtection&) = delete;
  InputProtection& operator=(const InputProtection&) = delete;
};

/// Registers an input file. All code that opens an input file must call this, whether the user named the file
/// or it was found in a folder, through a header or beside a recording. From any thread.
void register_input(const std::filesystem::path& path);

/// Returns whether the file is registered, compared by device and inode; always false without an
/// InputProtection. From any thread.
bool is_input(const std::filesystem::path& path);

}  // namespace osteomill
