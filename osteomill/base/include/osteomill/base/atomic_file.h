#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

namespace osteomill {

/// Where a file called `path` is to be written: the target of a symbolic link, else `path` itself. Whatever
/// writes a file asks this first. Throws InputError where the place is a folder, or a file that was read as
/// input (input_files.h).
std::filesystem::path output_path(const std::filesystem::path& path);

/// Calls `write` with the name of a file beside `path`, then renames that file to `path`, so that nobody ever
/// sees it half-written. Whatever `write` throws is passed on and the file beside is removed. A symbolic link
/// stays: what it leads to is written. What exists and is no regular file (a device, a FIFO) is not replaced
/// either: when all is written, the bytes go into it.
/// Throws InputError naming `path` where the file cannot be created, renamed or copied, or is a FIFO that
/// nobody reads.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& beside)>& write);

/// As `write_file_atomically`, for text: `write` fills the stream. Throws InputError where the stream failed
/// (a full disk).
void write_text_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

/// As `write_file_atomically`, for files that belong together: calls `write` with an empty folder, then moves
/// all that is in it into `folder`, over files of the same names. What `write` throws is passed on; then none
/// of its files is left, nor `folder` itself if it is new. Throws InputError where a file cannot be written.
/// What is `stale` in `folder`, by the names there, is removed when all is written and before it is moved, so
/// that nothing of an earlier output ever stands beside this one, also if the program is killed meanwhile;
/// the next call removes the folder that a killed one leaves.
void write_folder_atomically(const std::filesystem::path& folder,
                             const std::function<void(const std::filesystem::path& beside)>& write,
                             const std::function<bool(const std::string& name)>& stale = {});

/// Creates `folder` and its parents. Throws InputError naming it where that is impossible.
void create_folder(const std::filesystem::path& folder);

/// Where a program keeps things of its own for this user, by the freedesktop.org rules: what it remembers
/// ($XDG_STATE_HOME/osteomill, or ~/.local/state/osteomill), and how it is set up
/// ($XDG_CONFIG_HOME/osteomill, or ~/.config/osteomill). Empty where neither is known; nothing is created.
std::filesystem::path state_folder();
std::filesystem::path config_folder();

}  // namespace osteomill
