#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Hold this while calling HDF5, which is not thread-safe. The constructor also switches off HDF5's own error
/// output, because errors are thrown as InputError, and clears errno, which gives their reason.
class Hdf5Lock {
 public:
  Hdf5Lock();

 private:
  std::lock_guard<std::mutex> lock_;
};

/// Owns an HDF5 identifier and closes it on destruction, which must happen under Hdf5Lock.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);

  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Hdf5Handle() { close(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this != &other) {
      close();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      closer_ = other.closer_;
    }
    return *this;
  }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;

  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// Closes the identifier. Returns false if HDF5 reports an error.
  bool close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || closer_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// Returns a file access property list that switches off HDF5's file locks, which some file systems (NFS,
/// Lustre) lack. They are not needed: files to read are complete, because they appear by renaming, and files
/// being written are held by a FileLock or have a temporary name.
Hdf5Handle access_without_locks();

/// Largest magnitude accepted when reading; greater numbers could overflow in sums of squares.
inline constexpr double kMaxReal = 1e12;

/// Returns HDF5's type identifier for values in memory.
template <typename Value>
hid_t memory_type() {
  if constexpr (std::is_same_v<Value, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::is_same_v<Value, unsigned char>)
    return H5T_NATIVE_UCHAR;
  else if constexpr (std::is_same_v<Value, float>)
    return H5T_NATIVE_FLOAT;
  else if constexpr (std::is_same_v<Value, std::int32_t>)
    return H5T_NATIVE_INT32;
  else {
    static_assert(std::is_same_v<Value, std::uint64_t>, "HDF5 has no name for this type here");
    return H5T_NATIVE_UINT64;
  }
}

/// Attributes of one HDF5 object. All members throw InputError, naming the file and the attribute, on failure
/// and if an attribute to read is missing or has another type or length. Call under Hdf5Lock.
class Attributes {
 public:
  Attributes(std::filesystem::path file, hid_t object) : file_(std::move(file)), object_(object) {}

  /// Writes a text as UTF-8. Bytes that are not valid UTF-8, as in some paths, are mapped to U+F780 to
  /// U+F7FF, and back by `get`. Throws std::invalid_argument for a text of more than 60000 bytes, which HDF5
  /// would not store.
  void put(const std::string& name, const std::string& text) const;
  void put(const std::string& name, double value) const { put_reals(name, {&value, 1}); }
  void put(const std::string& name, std::uint64_t value) const;
  void put(const std::string& name, const Vec3& value) const { put_reals(name, {value.data(), 3}); }
  void put(const std::string& name, const std::array<int, 3>& values) const;
  void put_reals(const std::string& name, std::span<const double> values) const;
  /// Overwrites the value of an existing attribute.
  void replace(const std::string& name, std::uint64_t value) const;

  void get(const std::string& name, std::string& text) const;
  /// Reads a real; like all reals here it must be finite, its magnitude at most kMaxReal.
  void get(const std::string& name, double& value) const { get_reals(name, {&value, 1}); }
  void get(const std::string& name, std::uint64_t& value) const;
  void get(const std::string& name, Eigen::Ref<Vec3> value) const { get_reals(name, {value.data(), 3}); }
  void get(const std::string& name, std::array<int, 3>& values) const;
  /// Reads `values.size()` reals.
  void get_reals(const std::string& name, std::span<double> values) const;
  template <typename Value>
  Value get(const std::string& name) const {
    Value value;
    get(name, value);
    return value;
  }
  /// Reads a real that may be infinite but not NaN.
  double real_or_infinite(const std::string& name) const;
  bool has(const std::string& name) const;
  bool is_text(const std::string& name) const;
  /// Returns the names of all attributes in the order in which they were written.
  std::vector<std::string> names() const;

 private:
  void write(const std::string& name, hid_t file_type, hid_t memory_type, hsize_t count,
             const void* data) const;
  Hdf5Handle open(const std::string& name) const;
  void read(const std::string& name, H5T_class_t type_class, hid_t memory_type, hssize_t count,
            void* data) const;

  std::filesystem::path file_;
  hid_t object_;
};

}  // namespace osteomill
