#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/pipe_end.h"

namespace osteomill {

/// HDF5 file opened for reading.
struct Hdf5File {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  Hdf5Handle handle;

  hid_t id() const { return handle.get(); }
  /// Throws an InputError that names the file.
  [[noreturn]] void refuse(const std::string& reason) const;
};

/// Throws InputError if the path is not a regular file or another program is still writing it.
void require_readable(const std::filesystem::path& path);
/// Opens the file without HDF5's file lock. Throws InputError if it is not HDF5, or contains links, data
/// stored in other files, or filters not built into HDF5. Call under Hdf5Lock.
Hdf5File open_hdf5(const std::filesystem::path& path);
/// Runs `put` in a child process and `take` in this one, at the two ends of a pipe. Throws InputError, naming
/// the file, with the child's reason if it refused the file, or if the child crashed, hung or cannot be
/// started.
void pass_from_child(const std::filesystem::path& path, const std::function<void(PipeEnd&)>& put,
                     const std::function<void(PipeEnd&)>& take);

/// Returns `read(file)`, `file` being an Hdf5File. On some damaged files HDF5 crashes, hangs or silently
/// corrupts memory, so a child process reads the file and passes the result on (pipe_end.h). Use this for
/// every HDF5 file that may come from somebody else.
template <typename Read>
auto read_hdf5(const std::filesystem::path& path, const Read& read) {
  const Hdf5Lock lock;
  require_readable(path);
  decltype(read(open_hdf5(path))) content;
  pass_from_child(
      path,
      [&](PipeEnd& pipe) {
        content = read(open_hdf5(path));
        bool is_read = true;
        pass(pipe, is_read);
        pass(pipe, content);
      },
      [&](PipeEnd& pipe) { pass(pipe, content); });
  return content;
}

/// Dataset of `width` numbers per row.
struct Hdf5Column {
  std::string place;
  Hdf5Handle dataset;
  hsize_t width = 1;
  std::size_t rows = 0;
};

/// Opens a column. Throws InputError if it is missing, does not have numbers of this width, or claims more
/// rows than the file can hold.
Hdf5Column open_column(const Hdf5File& file, const std::string& place, hsize_t width = 1);

/// Returns all values of a column. Throws InputError if they cannot be read.
template <typename Value>
std::vector<Value> read_values(const Hdf5File& file, const Hdf5Column& column) {
  std::vector<Value> values(column.rows * column.width);
  if (!values.empty() &&
      H5Dread(column.dataset.get(), memory_type<Value>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    file.refuse("the column '" + column.place + "' cannot be read");
  return values;
}

}  // namespace osteomill
