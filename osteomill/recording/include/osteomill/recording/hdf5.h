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

/// To be held while HDF5 is called: the library is not safe in two threads at once. Also switches off its
/// printing of errors, which are thrown as InputError instead, and clears errno, which tells their reason.
class Hdf5Lock {
 public:
  Hdf5Lock();

 private:
  std::lock_guard<std::mutex> lock_;
};

/// An identifier of HDF5's that is closed when it goes. To be destroyed under Hdf5Lock.
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
  /// False if HDF5 could not close it in order.
  bool close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || closer_(id) >= 0;
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// Returns how a file is opened or created without a lock of HDF5's, which some file systems (NFS, Lustre) do
/// not have: what is read is whole, since files appear by being renamed, and what is written is held by a
/// FileLock or has a name of its own until it is whole.
Hdf5Handle access_without_locks();

/// Greater numbers overflow in sums of squares, and are refused where they are read.
inline constexpr double kMaxReal = 1e12;

/// HDF5's name for what stands in memory.
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

/// The attributes of one object. Every failure, also of one that is missing, of another type or length, is an
/// InputError that names the file and the attribute. Under Hdf5Lock.
class Attributes {
 public:
  Attributes(std::filesystem::path file, hid_t object) : file_(std::move(file)), object_(object) {}

  /// Writes a text as UTF-8. Bytes that are none, as those of some paths, become characters of their own
  /// (U+F780 to U+F7FF), of which `get` makes the same bytes again. Throws std::invalid_argument for a text
  /// of more than 60000 bytes, which HDF5 would not store.
  void put(const std::string& name, const std::string& text) const;
  void put(const std::string& name, double value) const { put_reals(name, {&value, 1}); }
  void put(const std::string& name, std::uint64_t value) const;
  void put(const std::string& name, const Vec3& value) const { put_reals(name, {value.data(), 3}); }
  void put(const std::string& name, const std::array<int, 3>& values) const;
  void put_reals(const std::string& name, std::span<const double> values) const;
  /// Writes over the value of an attribute that is there.
  void replace(const std::string& name, std::uint64_t value) const;

  void get(const std::string& name, std::string& text) const;
  /// Finite and up to kMaxReal, as all reals.
  void get(const std::string& name, double& value) const { get_reals(name, {&value, 1}); }
  void get(const std::string& name, std::uint64_t& value) const;
  void get(const std::string& name, Eigen::Ref<Vec3> value) const { get_reals(name, {value.data(), 3}); }
  void get(const std::string& name, std::array<int, 3>& values) const;
  /// Reads as many as there is room for.
  void get_reals(const std::string& name, std::span<double> values) const;
  template <typename Value>
  Value get(const std::string& name) const {
    Value value;
    get(name, value);
    return value;
  }
  /// A real that may be infinite, but not NaN.
  double real_or_infinite(const std::string& name) const;
  bool has(const std::string& name) const;
  bool is_text(const std::string& name) const;
  /// In the order in which they were written.
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
