#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace osteomill {

/// Returns the place to write a file called `path` to: the target of a symbolic link, else `path` itself. All
/// code that writes a file asks this first. Throws InputError if the place is a folder, or a file that was
/// read as input (input_files.h).
std::filesystem::path output_path(const std::filesystem::path& path);

/// Calls `write` with the name of a file beside `path`, then renames that file to `path`, so that no program
/// ever sees it half-written. If `write` throws, the exception is passed on and the file beside is removed. A
/// symbolic link stays: what it leads to is written. What exists and is no regular file (a device, a FIFO) is
/// not replaced either: when all is written, the bytes go into it.
/// Throws InputError naming `path` if the file cannot be created, renamed or copied, or is a FIFO that no
/// program reads.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& beside)>& write);

/// Writes a text as `write_file_atomically` writes a file; `write` fills the stream. Throws InputError if the
/// stream failed (a full disk).
void write_text_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

/// Writes files that belong together as `write_file_atomically` writes one: calls `write` with an empty
/// folder, then moves all that is in it into `folder`, over files of the same names. What `write` throws is
/// passed on; then none of its files is left, nor `folder` itself if it is new. Throws InputError if a file
/// cannot be written. Files in `folder` whose name is `stale` are removed when all is written and before it
/// is moved, so that nothing of an earlier output ever stands beside this one, also if the program is killed
/// meanwhile; the next call removes the folder that a killed one leaves.
void write_folder_atomically(const std::filesystem::path& folder,
                             const std::function<void(const std::filesystem::path& beside)>& write,
                             const std::function<bool(const std::string& name)>& stale = {});

/// Creates `folder` and its parents. Throws InputError naming it if that is impossible.
void create_folder(const std::filesystem::path& folder);

/// Returns the folder for what a program remembers for this user, by the freedesktop.org rules:
/// $XDG_STATE_HOME/osteomill, or ~/.local/state/osteomill; empty if neither is known. Creates nothing.
std::filesystem::path state_folder();
/// Returns the folder for how a program is set up for this user: $XDG_CONFIG_HOME/osteomill, or
/// ~/.config/osteomill; empty if neither is known. Creates nothing.
std::filesystem::path config_folder();

}  // namespace osteomill
