#include "osteomill/files/atomic_file.h"

#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Keeps the extension last, since libraries choose a format by it.
fs::path name_beside(const fs::path& path) {
  const std::string name =
      "." + path.stem().string() + ".writing-" + std::to_string(::getpid()) + path.extension().string();
  return path.parent_path() / name;
}

void write_into(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const TemporaryFolder folder;
  const fs::path whole = folder / ("whole" + path.extension().string());
  write(whole);
  std::ofstream out(path, std::ios::binary);
  out << std::ifstream(whole, std::ios::binary).rdbuf();
  out.close();
  if (!out) throw InputError(path.string(), "cannot be written to its end");
}

}  // namespace

fs::path behind_links(const fs::path& path) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  fs::path target = path;
  for (int n = 0; fs::is_symlink(fs::symlink_status(target, error)); ++n) {
    if (n == kMostLinks) throw InputError(path.string(), "is a link that leads to itself");
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  return target;
}

void write_file_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code error;
  const fs::path target = behind_links(path);
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) throw InputError(path.string(), "cannot be written: it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) return write_into(path, write);
  const fs::path beside = name_beside(target);
  try {
    write(beside);
  } catch (...) {
    fs::remove(beside, error);
    throw;
  }
  fs::rename(beside, target, error);
  if (error) {
    const std::string reason = "cannot be written: " + error.message();
    fs::remove(beside, error);
    throw InputError(path.string(), reason);
  }
}

void write_text_atomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  write_file_atomically(path, [&](const fs::path& beside) {
    std::ofstream out(beside, std::ios::binary);
    if (!out) throw InputError(path.string(), "cannot be created");
    write(out);
    out.close();
    if (!out) throw InputError(path.string(), "cannot be written to its end (is the disk full?)");
  });
}

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
}

void require_no_input(const fs::path& out, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  if (!fs::exists(out, ignored)) return;
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const bool same = fs::equivalent(out, input, ignored) ||
                      fs::equivalent(fs::absolute(out, ignored).parent_path(), input, ignored);
    if (same) throw InputError(out.string(), "is what is read; name another file to write");
  }
}

}  // namespace osteomill
