#include "osteomill/files/atomic_file.h"

#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Keeps the extension last, since libraries choose a format by it.
fs::path name_beside(const fs::path& path) {
  const std::string name =
      "." + path.stem().string() + ".writing-" + std::to_string(::getpid()) + path.extension().string();
  return path.parent_path() / name;
}

}  // namespace

void write_file_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path beside = name_beside(path);
  std::error_code error;
  try {
    write(beside);
  } catch (...) {
    fs::remove(beside, error);
    throw;
  }
  fs::rename(beside, path, error);
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
