#include "osteomill/base/atomic_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"
#include "osteomill/base/signal_cleanup.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Creates a file or folder with a new name in the folder of `path`; `create` must fail with EEXIST if the
// name is taken. Keeps the extension last, because libraries choose the format by it.
template <typename Create>
fs::path create_beside(const fs::path& path, const Create& create) {
  for (int number = 1;; ++number) {
    fs::path beside = path.parent_path() / ("." + path.stem().string() + ".writing-" +
                                            std::to_string(number) + path.extension().string());
    if (create(beside.c_str())) return beside;
    if (errno != EEXIST)
      throw InputError(path.string(), std::string("cannot be created: ") + std::strerror(errno));
  }
}

bool create_file(const char* path) {
  const int file = ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  return file >= 0 && ::close(file) == 0;
}

bool create_empty_folder(const char* path) {
  return ::mkdir(path, 0777) == 0;
}

bool is_device_or_pipe(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void write_to_special_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  // Without O_NONBLOCK, opening a FIFO blocks until another program reads it.
  const int reader_is_there = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  if (reader_is_there < 0)
    throw InputError(path.string(),
                     errno == ENXIO ? "is a pipe that no program reads" : "cannot be opened for writing");
  std::ofstream out(path, std::ios::binary);
  ::close(reader_is_there);
  const TemporaryFolder folder;
  const fs::path whole = folder / ("whole" + path.extension().string());
  write(whole);
  // Streaming an empty buffer sets failbit.
  if (!fs::is_empty(whole)) out << std::ifstream(whole, std::ios::binary).rdbuf();
  out.close();
  if (!out) throw InputError(path.string(), with_reason("cannot be written to its end"));
}

void rename_to(const fs::path& from, const fs::path& target, const fs::path& path) {
  std::error_code error;
  fs::rename(from, target, error);
  if (!error) return;
  const std::string reason = "cannot be written: " + error.message();
  fs::remove(from, error);
  throw InputError(path.string(), reason);
}

// An open folder whose lock shows that its owner is alive.
class LockedFolder {
 public:
  explicit LockedFolder(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC)) {}
  ~LockedFolder() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  LockedFolder(const LockedFolder&) = delete;
  LockedFolder& operator=(const LockedFolder&) = delete;
  // Also returns false if the file system has no such locks (folders on NFS).
  bool try_lock() const { return descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }

 private:
  int descriptor_;
};

constexpr const char* kBeside = "files";

// Removes temporary folders left by killed programs.
void remove_orphaned_folders(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename().string().starts_with("." + std::string(kBeside) + ".writing-") &&
        LockedFolder(entry.path()).try_lock())
      fs::remove_all(entry.path(), ignored);
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory()) files.push_back(entry.path().lexically_relative(folder));
  return files;
}

void require_not_input(const fs::path& path) {
  if (is_input(path)) throw InputError(path.string(), "is an input file; name another output file");
}

void remove_stale(const fs::path& folder, const std::function<bool(const std::string&)>& stale) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!stale(entry.path().filename().string())) continue;
    require_not_input(entry.path());
    found.push_back(entry.path());
  }
  for (const fs::path& path : found) {
    std::error_code error;
    fs::remove_all(path, error);
    if (error) throw InputError(path.string(), "cannot be removed: " + error.message());
  }
}

// Rethrows the current exception with the temporary file's name replaced by its final one.
[[noreturn]] void rethrow_with_final_name(const fs::path& beside, const fs::path& folder) {
  try {
    throw;
  } catch (const InputError& error) {
    const std::string message = error.what(), name = in_one_line(beside.string());
    if (!message.starts_with(name)) throw;
    const std::size_t end = message.find(": ", name.size());
    throw InputError(folder.string() + message.substr(name.size(), end - name.size()),
                     message.substr(end + 2));
  }
}

// Ignores relative paths.
fs::path folder_from_environment(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path folder = value != nullptr ? value : "";
  return folder.is_absolute() ? folder : fs::path();
}

fs::path user_folder(const char* variable, const char* in_home) {
  if (const fs::path named = folder_from_environment(variable); !named.empty()) return named / "osteomill";
  if (const fs::path home = folder_from_environment("HOME"); !home.empty())
    return home / in_home / "osteomill";
  return {};
}

}  // namespace

fs::path output_path(const fs::path& path) {
  constexpr int kMaxLinks = 40;
  std::error_code error;
  require_not_input(path);
  if (fs::is_directory(path, error)) throw InputError(path.string(), "cannot be written: it is a folder");
  // A system link to a pipe (/dev/stdout) cannot be resolved to a path.
  if (is_device_or_pipe(path)) return path;
  fs::path target = path;
  for (int n = 0; fs::is_symlink(fs::symlink_status(target, error)); ++n) {
    if (n == kMaxLinks) throw InputError(path.string(), "is a link that leads to itself");
    target = target.parent_path() / fs::read_symlink(target, error);
  }
  return target;
}

void write_file_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path target = output_path(path);
  if (is_device_or_pipe(target)) return write_to_special_file(path, write);
  const fs::path beside = create_beside(target, create_file);
  const SignalCleanup cleanup(beside);
  try {
    write(beside);
  } catch (...) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw;
  }
  rename_to(beside, target, path);
}

void write_text_atomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  write_file_atomically(path, [&](const fs::path& beside) {
    errno = 0;
    std::ofstream out(beside, std::ios::binary);
    if (!out) throw InputError(path.string(), with_reason("cannot be created"));
    write(out);
    out.close();
    if (!out) throw InputError(path.string(), with_reason("cannot be written to its end"));
  });
}

void write_folder_atomically(const fs::path& folder, const std::function<void(const fs::path&)>& write,
                             const std::function<bool(const std::string&)>& stale) {
  std::error_code ignored;
  const bool was_there = fs::exists(folder, ignored);
  create_folder(folder);
  remove_orphaned_folders(folder);
  const fs::path beside = create_beside(folder / kBeside, create_empty_folder);
  const LockedFolder held(beside);
  held.try_lock();
  const SignalCleanup cleanup(beside);
  try {
    write(beside);
    const std::vector<fs::path> files = files_in(beside);
    for (const fs::path& file : files) output_path(folder / file);
    if (stale) remove_stale(folder, stale);
    for (const fs::path& file : files) {
      create_folder((folder / file).parent_path());
      rename_to(beside / file, output_path(folder / file), folder / file);
    }
    fs::remove_all(beside, ignored);
  } catch (...) {
    fs::remove_all(beside, ignored);
    if (!was_there) fs::remove(folder, ignored);
    rethrow_with_final_name(beside, folder);
  }
}

void create_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "cannot be created: " + error.message());
}

fs::path state_folder() {
  return user_folder("XDG_STATE_HOME", ".local/state");
}

fs::path config_folder() {
  return user_folder("XDG_CONFIG_HOME", ".config");
}

}  // namespace osteomill
