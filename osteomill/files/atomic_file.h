#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>
#include <vector>

namespace osteomill {

/// Calls `write` with the name of a file beside `path`, then renames that file to `path`, so that nobody ever
/// sees it half-written. Whatever `write` throws is passed on and the file beside is removed. A symbolic link
/// stays: what it leads to is written. What exists and is no regular file (a device, a FIFO) is not replaced
/// either: when all is written, the bytes go into it.
/// Throws InputError naming `path` where the file cannot be created, renamed or copied.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& beside)>& write);

/// The same for text: `write` fills the stream; a stream that failed (a full disk) is an InputError.
void write_text_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream&)>& write);

/// Where a file called `path` is to be written: where it leads as a symbolic link, else itself.
std::filesystem::path behind_links(const std::filesystem::path& path);

/// Creates `folder` and its parents. Throws InputError naming it where that is impossible.
void create_folder(const std::filesystem::path& folder);

/// Throws InputError, naming `out`, where writing it would replace one of these inputs, or a file in one of
/// them that is a folder. Empty inputs mean nothing.
void require_no_input(const std::filesystem::path& out, const std::vector<std::filesystem::path>& inputs);

}  // namespace osteomill
