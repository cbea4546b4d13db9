#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/recording/hdf5_handle.h"

namespace osteomill {

/// Writes attributes of one object. Every failure is an InputError that names the file. Under Hdf5Lock.
class AttributeWriter {
 public:
  AttributeWriter(std::filesystem::path file, hid_t object) : file_(std::move(file)), object_(object) {}

  /// Throws std::invalid_argument for a text of more than 60000 bytes, which HDF5 would not store.
  void text(const std::string& name, const std::string& value) const;
  void real(const std::string& name, double value) const;
  void unsigned_integer(const std::string& name, std::uint64_t value) const;
  void reals(const std::string& name, std::span<const double> values) const;
  void vector(const std::string& name, const Vec3& value) const { reals(name, {value.data(), 3}); }
  void integers(const std::string& name, const std::array<int, 3>& values) const;
  /// Writes over the value of an attribute that is there.
  void replace_unsigned_integer(const std::string& name, std::uint64_t value) const;

 private:
  void write(const std::string& name, hid_t file_type, hid_t memory_type, hsize_t count,
             const void* data) const;

  std::filesystem::path file_;
  hid_t object_;
};

/// Reads attributes of one object. One that is missing, of another type or length is an InputError that names
/// the file and the attribute. Under Hdf5Lock.
class AttributeReader {
 public:
  AttributeReader(std::filesystem::path file, hid_t object) : file_(std::move(file)), object_(object) {}

  std::string text(const std::string& name) const;
  double real(const std::string& name) const;
  std::uint64_t unsigned_integer(const std::string& name) const;
  /// As many as there is room for.
  void reals(const std::string& name, std::span<double> values) const;
  Vec3 vector(const std::string& name) const;
  std::array<int, 3> integers(const std::string& name) const;
  bool has(const std::string& name) const;
  bool is_text(const std::string& name) const;
  /// In the order in which they were written.
  std::vector<std::string> names() const;

 private:
  Hdf5Handle open(const std::string& name) const;
  void read(const std::string& name, H5T_class_t type_class, hid_t memory_type, hssize_t count,
            void* data) const;

  std::filesystem::path file_;
  hid_t object_;
};

}  // namespace osteomill
