#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace osteomill {

/// Returns the path at which to write a file called `path`: the target of a symbolic link, else `path`
/// itself. Call before writing any file. Throws InputError if that is a folder, or a file that was read as
/// input (input_files.h).
std::filesystem::path output_path(const std::filesystem::path& path);

/// Calls `write` with the name of a temporary file in the same folder, then renames that file to `path`, so
/// that no program ever sees it half-written. If `write` throws, removes the temporary file and rethrows. A
/// symbolic link is kept and its target written. An existing special file (a device, a FIFO) is not replaced:
/// the finished bytes are copied into it. Throws InputError naming `path` if the file cannot be created,
/// renamed or copied, or is a FIFO that no program reads.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& beside)>& write);

/// Writes a text like `write_file_atomically`; `write` fills the stream. Throws InputError if the stream
/// failed (a full disk).
void write_text_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

/// Writes a set of files like `write_file_atomically`: calls `write` with an empty temporary folder, then
/// moves its content into `folder`, replacing files of the same names. If `write` throws, removes its files,
/// and `folder` too if it is new, and rethrows. Throws InputError if a file cannot be written. Removes files
/// in `folder` for whose names `stale` returns true, after writing and before moving, so that old and new
/// output never mix, even if the program is killed. A killed program leaves its temporary folder behind; the
/// next call removes it.
void write_folder_atomically(const std::filesystem::path& folder,
                             const std::function<void(const std::filesystem::path& beside)>& write,
                             const std::function<bool(const std::string& name)>& stale = {});

/// Creates `folder` and its parents. Throws InputError naming it on failure.
void create_folder(const std::filesystem::path& folder);

/// Returns the folder for the user's program state, by the freedesktop.org rules: $XDG_STATE_HOME/osteomill,
/// or ~/.local/state/osteomill; empty if HOME is not set either. Does not create it.
std::filesystem::path state_folder();
/// Returns the folder for the user's configuration: $XDG_CONFIG_HOME/osteomill, or ~/.config/osteomill; empty
/// if HOME is not set either. Does not create it.
std::filesystem::path config_folder();

}  // namespace osteomill
