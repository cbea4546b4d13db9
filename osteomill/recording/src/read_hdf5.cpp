#include "osteomill/recording/read_hdf5.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <optional>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

bool has_internal_data(hid_t dataset) {
  const Hdf5Handle layout(H5Dget_create_plist(dataset), H5Pclose);
  bool own = H5Pget_external_count(layout.get()) == 0 && H5Pget_layout(layout.get()) != H5D_VIRTUAL;
  for (int n = 0; own && n < H5Pget_nfilters(layout.get()); ++n) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(layout.get(), static_cast<unsigned>(n), &flags, &values, nullptr, 0, nullptr, &config);
    own = filter >= 0 && filter < H5Z_FILTER_RESERVED;
  }
  return own;
}

// Errors that mean the file cannot be locked.
bool is_lock_error(int error) {
  return error == ENOLCK || error == EAGAIN || error == ENOSYS || error == EOPNOTSUPP;
}

void require_self_contained(const Hdf5File& file) {
  std::string refused;
  const auto check_link = [](hid_t group, const char* name, const H5L_info_t* link, void* found) -> herr_t {
    bool within = link->type == H5L_TYPE_HARD;
    if (within) {
      const Hdf5Handle object(H5Oopen(group, name, H5P_DEFAULT), H5Oclose);
      const H5I_type_t type = H5Iget_type(object.get());
      within = type == H5I_GROUP || (type == H5I_DATASET && has_internal_data(object.get()));
    }
    if (!within) *static_cast<std::string*>(found) = name;
    return within ? 0 : 1;
  };
  if (H5Lvisit(file.id(), H5_INDEX_NAME, H5_ITER_NATIVE, check_link, &refused) != 0)
    file.refuse("'" + refused + "' is stored outside the file, or needs an HDF5 filter plugin");
}

// Limits the child's CPU and wall time and its core dump, and restores the default signal handlers. Standard
// error is discarded because the C library reports heap corruption there.
void limit_child(std::uintmax_t bytes) {
  constexpr unsigned kMinLimit_s = 2, kWaitingShare = 20;
  constexpr std::uintmax_t kBytesPerSecond = 5'000'000;
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  const unsigned max_s = kMinLimit_s + static_cast<unsigned>(bytes / kBytesPerSecond);
  const rlimit processor{max_s, max_s};
  ::setrlimit(RLIMIT_CPU, &processor);
  ::alarm(kWaitingShare * max_s);
  const rlimit no_dump{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_dump);
  ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
}

// Returns nullopt if the child passed everything; otherwise its reason to refuse the file, empty if it ended
// early.
std::optional<std::string> taken(PipeEnd& pipe, const std::function<void(PipeEnd&)>& take) {
  try {
    bool is_read = false;
    pass(pipe, is_read);
    if (is_read) {
      take(pipe);
      return std::nullopt;
    }
    std::string reason;
    pass(pipe, reason);
    return reason;
  } catch (const std::runtime_error&) {
    return "";
  }
}

[[noreturn]] void run_child(const fs::path& path, PipeEnd& pipe, const std::function<void(PipeEnd&)>& put) {
  int code = 0;
  try {
    try {
      put(pipe);
    } catch (const InputError& error) {
      bool is_read = false;
      std::string reason = error.what();
      const std::string subject = in_one_line(path.string()) + ": ";
      if (reason.starts_with(subject)) reason.erase(0, subject.size());
      pass(pipe, is_read);
      pass(pipe, reason);
    }
    pipe.flush();
  } catch (...) {
    code = 1;
  }
  ::_exit(code);
}

}  // namespace

void Hdf5File::refuse(const std::string& reason) const {
  throw InputError(path.string(), reason);
}

void require_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path.string(), "no such file");
  if (!fs::is_regular_file(status)) throw InputError(path.string(), "is not a file");
  if (is_locked(path))
    throw InputError(path.string(), "is still being written; wait until its program has ended");
}

Hdf5File open_hdf5(const fs::path& path) {
  std::error_code error;
  Hdf5File file{path, fs::file_size(path, error), {}};
  if (H5Fis_hdf5(path.c_str()) <= 0) file.refuse("is not an HDF5 file");
  const Hdf5Handle access = access_without_locks();
  errno = 0;
  file.handle = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file.handle.valid() && is_lock_error(errno))
    file.refuse(with_reason("cannot be locked; unset HDF5_USE_FILE_LOCKING"));
  if (!file.handle.valid()) file.refuse("cannot be opened: it is truncated or damaged");
  require_self_contained(file);
  return file;
}

void pass_from_child(const fs::path& path, const std::function<void(PipeEnd&)>& put,
                     const std::function<void(PipeEnd&)>& take) {
  // Limits on what the child passes: bytes per byte of the file, and the length of a refusal.
  constexpr std::uintmax_t kMaxBytesPerByte = 10'000, kMaxReasonBytes = 1'000'000;
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error), most = kMaxBytesPerByte * bytes + kMaxReasonBytes;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw InputError(path.string(), "cannot be read: too many open files; raise the limit (ulimit -n)");
  const ::pid_t child = ::fork();
  if (child == 0) {
    limit_child(bytes);
    ::close(ends[0]);
    PipeEnd pipe(ends[1], PipeEnd::Direction::write, most);
    run_child(path, pipe, put);
  }
  ::close(ends[1]);
  std::optional<std::string> fault;
  {
    PipeEnd pipe(ends[0], PipeEnd::Direction::read, most);
    fault = taken(pipe, take);
  }
  if (child < 0)
    throw InputError(path.string(), "cannot be read: no process can be started; raise the limit (ulimit -u)");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (status != 0 || (fault && fault->empty()))
    throw InputError(path.string(), "is damaged: HDF5 crashes or hangs when reading it");
  if (fault) throw InputError(path.string(), *fault);
}

Hdf5Column open_column(const Hdf5File& file, const std::string& place, hsize_t width) {
  // Allows one row per byte of the file, which suffices for files compressed by other programs; for wide
  // rows, allows deflate's maximum ratio.
  constexpr hsize_t kMaxDeflateRatio = 1100;
  Hdf5Column column{place, Hdf5Handle(H5Dopen2(file.id(), place.c_str(), H5P_DEFAULT), H5Dclose), width};
  if (!column.dataset.valid()) file.refuse("has no column '" + place + "'");
  const Hdf5Handle type(H5Dget_type(column.dataset.get()), H5Tclose);
  const H5T_class_t type_class = H5Tget_class(type.get());
  const Hdf5Handle space(H5Dget_space(column.dataset.get()), H5Sclose);
  const int rank = width == 1 ? 1 : 2;
  std::array<hsize_t, 2> size{0, 1};
  if ((type_class != H5T_FLOAT && type_class != H5T_INTEGER) ||
      H5Sget_simple_extent_ndims(space.get()) != rank ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) != rank || (rank == 2 && size[1] != width))
    file.refuse("'" + place + "' is not a column of numbers");
  const hsize_t most = rank == 1 ? file.bytes : kMaxDeflateRatio * file.bytes / (width * sizeof(float));
  if (size[0] > most)
    file.refuse(fmt::format("'{}' claims {} rows, more than the file can hold", place, size[0]));
  column.rows = size[0];
  return column;
}

}  // namespace osteomill
