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

/// A file that is open for reading.
struct Hdf5File {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  Hdf5Handle handle;

  hid_t id() const { return handle.get(); }
  /// Throws InputError that names the file.
  [[noreturn]] void refuse(const std::string& reason) const;
};

/// Throws InputError if the path leads to no regular file, or to one that another program is writing.
void require_readable(const std::filesystem::path& path);
/// Opens the file, without a lock of HDF5's. Throws InputError if it is not HDF5, or holds what leads out
/// of it: links, values in other files, filters that are not HDF5's own. Under Hdf5Lock.
Hdf5File open_hdf5(const std::filesystem::path& path);
/// Lets a child process `put` something into a pipe, and this one `take` it. Throws InputError, naming the
/// file, with the reason for which the child refused it, or if the child ended otherwise, did not end, or
/// cannot be started.
void pass_from_child(const std::filesystem::path& path, const std::function<void(PipeEnd&)>& put,
                     const std::function<void(PipeEnd&)>& take);

/// Returns what `read` makes of the file, an Hdf5File. HDF5 ends the program on some files, never comes back,
/// or writes beyond its memory without a sign, so it is a child process that reads, and what it read is
/// passed on (pipe_end.h). This is how every file of HDF5 is read whose content somebody else may have made.
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

/// A dataset of `width` numbers a row.
struct Hdf5Column {
  std::string place;
  Hdf5Handle dataset;
  hsize_t width = 1;
  std::size_t rows = 0;
};

/// Throws InputError if there is no such column, or it claims more rows than the file could hold.
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
