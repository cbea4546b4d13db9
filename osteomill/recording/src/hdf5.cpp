#include "osteomill/recording/hdf5.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "osteomill/base/input_error.h"

namespace osteomill {

namespace {

std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

constexpr std::size_t kMaxText = 60000;

// Maps each byte from 0x80 on to a character of the private use area.
constexpr std::uint32_t kByteAsCharacter = 0xF700;

// Code point and length in bytes of a UTF-8 character; length 0 if it is invalid.
struct Character {
  std::size_t bytes = 0;
  std::uint32_t code = 0;
};
Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t n) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[n]));
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {1, first};
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC0 || first >= 0xF8 || bytes > text.size()) return {};
  std::uint32_t code = first & (0x7Fu >> bytes);
  for (std::size_t n = 1; n < bytes; ++n) {
    if ((byte(n) & 0xC0u) != 0x80) return {};
    code = (code << 6u) | (byte(n) & 0x3Fu);
  }
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[bytes] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) return {};
  return {bytes, code};
}

bool is_byte_character(const Character& character) {
  return character.code >= kByteAsCharacter + 0x80 && character.code <= kByteAsCharacter + 0xFF;
}

std::string as_utf8(std::string_view bytes) {
  std::string text;
  while (!bytes.empty()) {
    const Character character = first_character(bytes);
    const std::size_t taken = std::max<std::size_t>(1, character.bytes);
    if (character.bytes > 0 && !is_byte_character(character)) {
      text += bytes.substr(0, taken);
    } else {
      for (const char byte : bytes.substr(0, taken)) {
        const std::uint32_t code = kByteAsCharacter + static_cast<unsigned char>(byte);
        text += {static_cast<char>(0xE0u | (code >> 12u)), static_cast<char>(0x80u | ((code >> 6u) & 0x3Fu)),
                 static_cast<char>(0x80u | (code & 0x3Fu))};
      }
    }
    bytes.remove_prefix(taken);
  }
  return text;
}

std::string from_utf8(std::string_view text) {
  std::string bytes;
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t taken = std::max<std::size_t>(1, character.bytes);
    if (is_byte_character(character))
      bytes += static_cast<char>(character.code - kByteAsCharacter);
    else
      bytes += text.substr(0, taken);
    text.remove_prefix(taken);
  }
  return bytes;
}

}  // namespace

Hdf5Lock::Hdf5Lock() : lock_(hdf5_mutex()) {
  // Disables HDF5's exit handler, which crashes on files left half-written by a full disk; handles close
  // everything. Has an effect only before any other HDF5 call.
  [[maybe_unused]] static const herr_t asked = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  errno = 0;
}

Hdf5Handle access_without_locks() {
  Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), false, true);
  return access;
}

void Attributes::write(const std::string& name, hid_t file_type, hid_t memory_type, hsize_t count,
                       const void* data) const {
  const Hdf5Handle space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object_, name.c_str(), file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid() || H5Awrite(attribute.get(), memory_type, data) < 0) {
    throw InputError(file_.string(), "the attribute '" + name + "' cannot be written");
  }
}

void Attributes::put(const std::string& name, const std::string& bytes) const {
  const std::string text = as_utf8(bytes);
  if (text.size() > kMaxText) {
    throw std::invalid_argument("the text of '" + name + "' is too long for a recording");
  }
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), text.size() + 1);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  write(name, type.get(), type.get(), 1, text.c_str());
}

void Attributes::put(const std::string& name, std::uint64_t value) const {
  write(name, H5T_STD_U64LE, H5T_NATIVE_UINT64, 1, &value);
}

void Attributes::put_reals(const std::string& name, std::span<const double> values) const {
  write(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.size(), values.data());
}

void Attributes::put(const std::string& name, const std::array<int, 3>& values) const {
  write(name, H5T_STD_I32LE, H5T_NATIVE_INT, values.size(), values.data());
}

void Attributes::replace(const std::string& name, std::uint64_t value) const {
  const Hdf5Handle attribute(H5Aopen(object_, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.valid() || H5Awrite(attribute.get(), H5T_NATIVE_UINT64, &value) < 0) {
    throw InputError(file_.string(), "the attribute '" + name + "' cannot be written");
  }
}

Hdf5Handle Attributes::open(const std::string& name) const {
  Hdf5Handle attribute(H5Aopen(object_, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) throw InputError(file_.string(), "has no attribute '" + name + "'");
  return attribute;
}

void Attributes::read(const std::string& name, H5T_class_t type_class, hid_t memory_type, hssize_t count,
                      void* data) const {
  const Hdf5Handle attribute = open(name);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Tget_class(type.get()) != type_class || H5Sget_simple_extent_npoints(space.get()) != count) {
    throw InputError(file_.string(), "the attribute '" + name + "' has the wrong type or length");
  }
  if (H5Aread(attribute.get(), memory_type, data) < 0) {
    throw InputError(file_.string(), "the attribute '" + name + "' cannot be read");
  }
}

void Attributes::get(const std::string& name, std::string& text) const {
  const Hdf5Handle attribute = open(name);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const std::size_t size = H5Tget_size(type.get());
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 ||
      size > kMaxText + 1 || H5Sget_simple_extent_npoints(space.get()) != 1) {
    throw InputError(file_.string(), "the attribute '" + name + "' is not a short text");
  }
  text.assign(size, '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0) {
    throw InputError(file_.string(), "the attribute '" + name + "' cannot be read");
  }
  text = from_utf8(std::string_view(text).substr(0, std::min(size, text.find('\0'))));
}

double Attributes::real_or_infinite(const std::string& name) const {
  double value = 0;
  read(name, H5T_FLOAT, H5T_NATIVE_DOUBLE, 1, &value);
  if (std::isnan(value)) throw InputError(file_.string(), "the attribute '" + name + "' is not a number");
  return value;
}

void Attributes::get(const std::string& name, std::uint64_t& value) const {
  read(name, H5T_INTEGER, H5T_NATIVE_UINT64, 1, &value);
}

void Attributes::get_reals(const std::string& name, std::span<double> values) const {
  read(name, H5T_FLOAT, H5T_NATIVE_DOUBLE, std::ssize(values), values.data());
  if (!std::ranges::all_of(values, [](double value) { return std::abs(value) <= kMaxReal; }))
    throw InputError(file_.string(), "the attribute '" + name + "' is not finite or exceeds 1e12");
}

void Attributes::get(const std::string& name, std::array<int, 3>& values) const {
  read(name, H5T_INTEGER, H5T_NATIVE_INT, 3, values.data());
}

bool Attributes::has(const std::string& name) const {
  return H5Aexists(object_, name.c_str()) > 0;
}

bool Attributes::is_text(const std::string& name) const {
  const Hdf5Handle attribute = open(name);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  return H5Tget_class(type.get()) == H5T_STRING;
}

std::vector<std::string> Attributes::names() const {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  hsize_t from = 0;
  if (H5Aiterate2(object_, H5_INDEX_CRT_ORDER, H5_ITER_INC, &from, collect, &names) < 0) {
    throw InputError(file_.string(), "the attributes of its settings cannot be listed");
  }
  return names;
}

}  // namespace osteomill
